#include "outcrop/fracture/joints.h"

#include <algorithm>
#include <cmath>

#include "outcrop/core/error.h"
#include "outcrop/fracture/samples.h"
#include "wrapped_grid.h"

namespace outcrop {
namespace {

constexpr double kPatternSide = 20.0;  // Metres: patterns give their lengths for the tile of the paper, section 4.
constexpr int kCentreAttempts = 24;    // Candidates for a centre before a crowded set takes the roomiest one.

// Rhombohedral: the normals of three sets at 65° to each other about the cube's diagonal. Their angle θ to it follows
// from cos 65° = 1 − 3/2 sin²θ. At 60° they would be the diagonals (0 1 1), (1 0 1), (1 1 0).
std::vector<JointSet> rhombohedral_sets(JointSet set) {
  const double sine = std::sqrt((1.0 - std::cos(radians(65.0))) / 1.5);
  const double cosine = std::sqrt(1.0 - sine * sine);
  const Vec3 axis = Vec3(1.0) / std::sqrt(3.0);
  std::vector<JointSet> sets;
  for (int i = 0; i < 3; ++i) {
    Vec3 away = axis;
    away[i] -= std::sqrt(3.0);  // from the i-th axis towards the face diagonal opposite to it
    set.normal = cosine * axis + sine * glm::normalize(away);
    sets.push_back(set);
  }
  return sets;
}

JointSet joint_set(const Vec3& normal, double kappa, double share, double radius_lo, double radius_hi) {
  return {.normal = normal, .kappa = kappa, .share = share, .radius_lo = radius_lo, .radius_hi = radius_hi};
}

double radius_of(const JointSet& set, double u) {
  if (set.radius_exponent <= 0.0 || set.radius_lo == set.radius_hi)
    return set.radius_lo + u * (set.radius_hi - set.radius_lo);
  const double a = set.radius_exponent;
  return set.radius_lo * std::pow(1.0 - u * (1.0 - std::pow(set.radius_lo / set.radius_hi, a)), -1.0 / a);
}

/// The discs of one set so far.
class SetDiscs {
 public:
  /// @param reach  Metres beyond which discs do not mind each other.
  SetDiscs(double side, double reach) : side_(side), grid_(side, reach) {}

  /// Blue noise by rejection: the first candidate with room, or the one with most room. Centres keep `spacing`, and
  /// discs that lie over each other keep `shadow` along the normal.
  [[nodiscard]] Vec3 draw_centre(const Vec3& normal, double radius, double spacing, double shadow, Rng& rng) const {
    Vec3 best{0.0};
    double best_room = -1.0;
    for (int attempt = 0; attempt < kCentreAttempts && best_room < 1.0; ++attempt) {
      Vec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = side_ * rng.uniform();
      double room = 1.0;  // 1: enough
      grid_.visit_near(p, [&](std::uint32_t i) {
        const Vec3 d = wrapped_difference(p, discs_[i].centre, side_);
        const double height = std::abs(glm::dot(normal, d));
        const double aside = glm::length(d - glm::dot(normal, d) * normal);
        room = std::min(room, glm::length(d) / spacing);
        room = std::min(room, std::max(height / shadow, aside / (radius + discs_[i].radius)));
      });
      if (room > best_room) {
        best_room = room;
        best = p;
      }
    }
    return best;
  }

  void insert(const Disc& disc) {
    discs_.push_back(disc);
    grid_.insert(disc.centre);
  }
  [[nodiscard]] int count() const noexcept { return static_cast<int>(discs_.size()); }

 private:
  double side_;
  WrappedGrid grid_;
  std::vector<Disc> discs_;
};

// The set whose number of discs is farthest below its share.
std::size_t next_set(const JointPattern& pattern, const std::vector<SetDiscs>& drawn, int total) {
  double share_sum = 0.0;
  for (const JointSet& set : pattern.sets) share_sum += set.share;
  std::size_t best = 0;
  double most = -1e300;
  for (std::size_t s = 0; s < drawn.size(); ++s) {
    const double missing = pattern.sets[s].share / share_sum * (total + 1) - drawn[s].count();
    if (missing > most) {
      most = missing;
      best = s;
    }
  }
  return best;
}

}  // namespace

std::string_view name(BlockType type) noexcept {
  switch (type) {
    case BlockType::Equidimensional:
      return "equidimensional";
    case BlockType::Rhombohedral:
      return "rhombohedral";
    case BlockType::Polyhedral:
      return "polyhedral";
    case BlockType::Tabular:
      return "tabular";
    case BlockType::Columnar:
      return "columnar";
    case BlockType::Prismatic:
      return "prismatic";
  }
  return "unknown";
}

// Numbers of discs and centre spacings are those of Paris et al. 2020, section 4.1 and Table 1. Radii are as there for
// bedding, about as there for polyhedral rock, and up to twice as long elsewhere: our joints end at others, and with 15
// discs of 5 m there would be 60 blocks, not 125. Concentrations and stress shadows are ours: see
// docs/decisions/fracture.md.
JointPattern joint_pattern(BlockType type) {
  const Vec3 x(1, 0, 0);
  const Vec3 y(0, 1, 0);
  const Vec3 z(0, 0, 1);
  switch (type) {
    case BlockType::Equidimensional:
      return {.sets = {joint_set(x, 200, 1, 8, 12), joint_set(y, 200, 1, 8, 12), joint_set(z, 200, 1, 8, 12)},
              .discs = 15,
              .irregular_share = 0.1,
              .least_thickness = 1.8};
    case BlockType::Rhombohedral:
      return {.sets = rhombohedral_sets(joint_set(z, 250, 1, 5, 7)), .discs = 24, .least_thickness = 2.0};
    case BlockType::Polyhedral:
      return {.sets = {joint_set(z, 1, 1, 3, 4)},  // κ does not matter: all are irregular
              .discs = 44,
              .irregular_share = 1.0,
              .centre_spacing = 1.0,
              .least_thickness = 1.6,
              .least_angle = radians(35.0)};
    case BlockType::Tabular:
      return {.sets = {joint_set(z, 600, 2, 20, 20), joint_set(x, 80, 1, 2.8, 4), joint_set(y, 80, 1, 2.8, 4)},
              .discs = 30,
              .least_thickness = 0.8};
    case BlockType::Columnar:
      return {.sets = {joint_set(z, 150, 1, 1.35, 1.8)},
              .discs = 90,
              .column_width = 2.4,
              .covered_share = 0.5,
              .least_thickness = 1.6};
    case BlockType::Prismatic:
      return {.sets = {joint_set(x, 60, 1, 6.5, 9), joint_set(y, 60, 1, 6.5, 9), joint_set(z, 60, 0.4, 3, 5)},
              .discs = 18,
              .least_thickness = 1.6};
  }
  return {};
}

void check_pattern(const JointPattern& pattern) {
  require(pattern.discs >= 0 && pattern.discs <= 100'000, "discs", "in 0 … 100000", pattern.discs);
  require(pattern.irregular_share >= 0.0 && pattern.irregular_share <= 1.0, "irregular_share", "in [0, 1]",
          pattern.irregular_share);
  require(pattern.centre_spacing >= 0.0, "centre_spacing", "≥ 0", pattern.centre_spacing);
  require(pattern.column_width >= 0.0 && pattern.column_width <= kPatternSide / 5.0, "column_width",
          "in [0, 4] at a tile of 20", pattern.column_width);
  require(pattern.column_width == 0.0 || pattern.column_width >= kPatternSide / 100.0, "column_width",
          "0 or at least 0.2 at a tile of 20", pattern.column_width);
  require(pattern.covered_share >= 0.0 && pattern.covered_share <= 1.0, "covered_share", "in [0, 1]",
          pattern.covered_share);
  require(pattern.least_thickness >= 0.0 && pattern.least_thickness <= kPatternSide / 4.0, "least_thickness",
          "in [0, 5] at a tile of 20", pattern.least_thickness);
  require(pattern.least_angle >= 0.0 && pattern.least_angle <= kPi / 3.0, "least_angle", "in [0, π/3]",
          pattern.least_angle);
  double shares = 0.0;
  for (const JointSet& set : pattern.sets) {
    const double length = glm::length(set.normal);
    require(std::abs(length - 1.0) < 1e-6, "normal", "a unit vector", length);
    require(std::isfinite(set.kappa) && set.kappa > 0.0, "kappa", "> 0 and finite", set.kappa);
    require(std::isfinite(set.share) && set.share >= 0.0, "share", "≥ 0 and finite", set.share);
    require(set.radius_lo > 0.0, "radius_lo", "> 0", set.radius_lo);
    require(set.radius_hi >= set.radius_lo && set.radius_hi <= 10.0 * kPatternSide, "radius_hi",
            "at least radius_lo, at most 200 at a tile of 20", set.radius_hi);
    require(set.radius_exponent >= 0.0 && set.radius_exponent <= 20.0, "radius_exponent", "in [0, 20]",
            set.radius_exponent);
    shares += set.share;
  }
  require(pattern.discs == 0 || shares > 0.0, "share", "a sum > 0 over the joint sets", shares);
}

std::vector<Disc> draw_discs(const JointPattern& pattern, double side, Seed seed) {
  require(std::isfinite(side) && side > 0.0, "side", "> 0 and finite", side);
  check_pattern(pattern);
  const double scale = side / kPatternSide;
  const double least = side * 1e-6;  // what is divided by
  const double spacing = std::max(pattern.centre_spacing * scale, least);
  const double shadow = std::max(pattern.least_thickness * scale, least);
  std::vector<SetDiscs> drawn;
  for (const JointSet& set : pattern.sets)
    drawn.emplace_back(side, std::max({spacing, shadow, 2.0 * set.radius_hi * scale, side / 64.0}));
  std::vector<Disc> discs;
  for (int i = 0; i < pattern.discs; ++i) {
    Rng rng(seed, "discs", static_cast<std::uint64_t>(i));
    const std::size_t s = next_set(pattern, drawn, i);
    const JointSet& set = pattern.sets[s];
    // Irregular discs are spread evenly over the sequence: the count is right, not only its mean.
    const double share = pattern.irregular_share;
    const bool irregular = std::floor((i + 1) * share + 0.5) > std::floor(i * share + 0.5);
    Disc disc;
    disc.radius = scale * radius_of(set, rng.uniform());
    disc.centre = drawn[s].draw_centre(set.normal, disc.radius, spacing, irregular ? least : shadow, rng);
    drawn[s].insert(disc);
    disc.set = irregular ? -1 : static_cast<int>(s);
    disc.normal = irregular ? rng.direction() : fisher_direction(set.normal, set.kappa, rng);
    discs.push_back(disc);
  }
  std::stable_sort(discs.begin(), discs.end(), [](const Disc& a, const Disc& b) { return a.radius > b.radius; });
  return discs;
}

double intensity(const std::vector<Disc>& discs, double side) noexcept {
  double area = 0.0;
  for (const Disc& disc : discs) area += kPi * disc.radius * disc.radius;
  return area / (side * side * side);
}

Vec3 fisher_direction(const Vec3& mean, double kappa, Rng& rng) {
  const double u = rng.uniform();
  const double turn = 2.0 * kPi * rng.uniform();
  // The log form: e^κ would overflow from κ = 710 on.
  const double cosine = std::clamp(1.0 + std::log(u + (1.0 - u) * std::exp(-2.0 * kappa)) / kappa, -1.0, 1.0);
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const Vec3 helper = std::abs(mean.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 a = glm::normalize(glm::cross(helper, mean));
  const Vec3 b = glm::cross(mean, a);
  return glm::normalize(cosine * mean + sine * (std::cos(turn) * a + std::sin(turn) * b));
}

}  // namespace outcrop

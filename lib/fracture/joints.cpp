#include "outcrop/fracture/joints.h"

#include <algorithm>
#include <cmath>

#include "joint_laws.h"
#include "lattice.h"
#include "outcrop/core/box.h"
#include "outcrop/fracture/samples.h"
#include "wrapped_grid.h"

namespace outcrop {
namespace {

constexpr int kCentreAttempts = 24;    // Candidates for a centre before a crowded set takes the roomiest one.
constexpr int kDenseAttempts = 5;      // The same for sets by spacing or P32, whose discs are many.
constexpr double kCrowdRadius = 2.0;   // Of the least radius: larger discs of a set do not mind all of each other.

std::uint64_t stream(std::size_t set, std::size_t index) { return std::uint64_t{set} << 40 | index; }

/// The cube in which centres fall, wrapped around: the torus, or a box grown by the largest radius.
struct CentreCube {
  double lo = 0.0;
  double side = 0.0;

  [[nodiscard]] Vec3 point(Rng& rng) const {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = lo + side * rng.uniform();
    return p;
  }
  [[nodiscard]] Vec3 wrapped(Vec3 p) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double v = p[axis] - lo;
      p[axis] = lo + std::clamp(v - side * std::floor(v / side), 0.0, std::nextafter(side, 0.0));
    }
    return p;
  }
  [[nodiscard]] bool contains(const Vec3& p) const { return Box{Vec3(lo), Vec3(lo + side)}.contains(p); }
  [[nodiscard]] Vec3 middle() const { return Vec3(lo + 0.5 * side); }
  [[nodiscard]] double volume() const { return side * side * side; }
};

CentreCube centre_cube(const JointSet& set, double side, Domain domain) {
  if (domain == Domain::Torus) return {0.0, side};
  return {-set.radius_hi, side + 2.0 * set.radius_hi};
}

/// The discs of one set so far.
class SetDiscs {
 public:
  /// @param reach  Metres beyond which discs do not mind each other. @param attempts  Candidates for a centre.
  SetDiscs(const CentreCube& cube, double reach, int attempts)
      : cube_(cube), attempts_(attempts), grid_(cube.side, reach) {}

  /// Blue noise by rejection: the first candidate with room, or the one with most room. Centres keep `spacing`, and
  /// discs that lie over each other keep `shadow` along the normal.
  template <class Candidate>
  [[nodiscard]] Vec3 draw_centre(const Vec3& normal, double radius, double spacing, double shadow, Candidate&& candidate,
                                 Rng& rng) const {
    Vec3 best{0.0};
    double best_room = -1.0;
    for (int attempt = 0; attempt < attempts_ && best_room < 1.0; ++attempt) {
      const Vec3 p = candidate(rng);
      double room = 1.0;  // 1: enough
      grid_.visit_near(p - cube_.lo, [&](std::uint32_t i) {
        const Vec3 d = wrapped_difference(p, discs_[i].centre, cube_.side);
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
    grid_.insert(disc.centre - cube_.lo);
  }
  [[nodiscard]] int count() const noexcept { return static_cast<int>(discs_.size()); }

 private:
  CentreCube cube_;
  int attempts_;
  WrappedGrid grid_;
  std::vector<Disc> discs_;
};

bool draw_end(const JointSet& set, Rng& rng) { return !set.ends_at.empty() && rng.uniform() < set.ends_share; }

// The set whose number of discs is farthest below its share.
std::size_t next_set(const std::vector<double>& shares, const std::vector<SetDiscs>& drawn, int total) {
  double share_sum = 0.0;
  for (const double share : shares) share_sum += share;
  std::size_t best = 0;
  double most = -1e300;
  for (std::size_t s = 0; s < drawn.size(); ++s) {
    const double missing = shares[s] / share_sum * (total + 1) - drawn[s].count();
    if (missing > most) {
      most = missing;
      best = s;
    }
  }
  return best;
}

std::vector<Disc> discs_by_share(const JointPattern& pattern, double side, Seed seed) {
  const CentreCube cube{0.0, side};
  const double least = side * 1e-6;  // what is divided by
  const double spacing = std::max(pattern.centre_spacing, least);
  const double shadow = std::max(pattern.least_thickness, least);
  std::vector<std::size_t> sets;
  std::vector<double> shares;
  std::vector<SetDiscs> drawn;
  for (std::size_t s = 0; s < pattern.sets.size(); ++s) {
    if (is_measured(pattern.sets[s])) continue;
    sets.push_back(s);
    shares.push_back(pattern.sets[s].share);
    drawn.emplace_back(cube, std::max({spacing, shadow, 2.0 * pattern.sets[s].radius_hi, side / 64.0}), kCentreAttempts);
  }
  std::vector<Disc> discs;
  if (sets.empty()) return discs;
  for (int i = 0; i < pattern.discs; ++i) {
    Rng rng(seed, "discs", static_cast<std::uint64_t>(i));
    const std::size_t s = next_set(shares, drawn, i);
    const JointSet& set = pattern.sets[sets[s]];
    // Irregular discs are spread evenly over the sequence: the count is right, not only its mean.
    const double share = pattern.irregular_share;
    const bool irregular = std::floor((i + 1) * share + 0.5) > std::floor(i * share + 0.5);
    Disc disc;
    disc.radius = draw_radius(set, rng);
    disc.centre = drawn[s].draw_centre(
        set.normal, disc.radius, spacing, irregular ? least : shadow, [&](Rng& r) { return cube.point(r); }, rng);
    drawn[s].insert(disc);
    disc.set = irregular ? -1 : static_cast<int>(sets[s]);
    disc.normal = irregular ? rng.direction() : draw_normal(set, rng);
    disc.ends = !irregular && draw_end(set, rng);
    discs.push_back(disc);
  }
  return discs;
}

// As many discs as bring Σ π r² nearest to what P32 asks for.
std::vector<Disc> discs_by_intensity(const JointPattern& pattern, std::size_t s, double side, Seed seed,
                                     Domain domain) {
  const JointSet& set = pattern.sets[s];
  const CentreCube cube = centre_cube(set, side, domain);
  const double least = side * 1e-6;
  const double spacing = std::max(pattern.centre_spacing, least);
  const double shadow = std::max(pattern.least_thickness, least);
  SetDiscs drawn(cube, std::max({spacing, shadow, 2.0 * std::min(set.radius_hi, kCrowdRadius * set.radius_lo),
                                 cube.side / 64.0}),
                 kDenseAttempts);
  std::vector<Disc> discs;
  const double wanted = set.p32 * cube.volume();
  for (double area = 0.0;;) {
    Rng rng(seed, "discs of a set", stream(s, discs.size()));
    Disc disc{.radius = draw_radius(set, rng), .set = static_cast<int>(s)};
    const double own = kPi * disc.radius * disc.radius;
    if (area + 0.5 * own > wanted) return discs;
    area += own;
    disc.centre = drawn.draw_centre(
        set.normal, disc.radius, spacing, shadow, [&](Rng& r) { return cube.point(r); }, rng);
    drawn.insert(disc);
    disc.normal = draw_normal(set, rng);
    disc.ends = draw_end(set, rng);
    discs.push_back(disc);
  }
}

// Sheets along the mean normal, each with discs in the proportion of its area that the persistence asks for.
std::vector<Disc> discs_on_sheets(const JointPattern& pattern, std::size_t s, double side, Seed seed, Domain domain) {
  const JointSet& set = pattern.sets[s];
  const GapRule rule{.least = pattern.least_thickness};
  const CentreCube cube = centre_cube(set, side, domain);
  Rng sheet_rng(seed, "sheets", s);
  Vec3 axis = set.normal;
  double area = 0.0;  // of the part of a sheet where darts fall
  double reach = 0.0;
  std::vector<double> sheets;
  if (domain == Domain::Torus) {  // a sheet closes when it lies across a whole vector
    const IVec3 m = nearest_whole_vector(set.normal);
    axis = unit(m);
    const double pitch = side / std::sqrt(dot(m, m));
    sheets = closed_positions(set, pitch, rule, false, sheet_rng);
    area = cube.volume() / pitch;
  } else {
    reach = 0.5 * std::sqrt(3.0) * cube.side;
    sheets = open_positions(set, reach, rule, sheet_rng);
    area = kPi * reach * reach;
  }
  if (sheets.empty()) return {};
  const Vec3 helper = std::abs(axis.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 a = glm::normalize(glm::cross(helper, axis));
  const Vec3 b = glm::cross(axis, a);

  SetDiscs drawn(cube, std::max(2.0 * std::min(set.radius_hi, kCrowdRadius * set.radius_lo), cube.side / 64.0),
                 kDenseAttempts);
  const double least = side * 1e-6;
  const double wanted = set.persistence * area * static_cast<double>(sheets.size());
  std::vector<Disc> discs;
  double covered = 0.0;
  for (std::size_t i = 0;; ++i) {
    Rng rng(seed, "discs on sheets", stream(s, i));
    Disc disc{.radius = draw_radius(set, rng), .set = static_cast<int>(s)};
    const double own = kPi * disc.radius * disc.radius;
    if (covered + 0.5 * own > wanted) return discs;
    covered += own;
    const double height = sheets[i % sheets.size()];
    const auto candidate = [&](Rng& r) {
      if (domain == Domain::Torus) {
        const Vec3 p = cube.point(r);
        return cube.wrapped(p + (height - glm::dot(axis, p)) * axis);
      }
      const double u = r.uniform(-reach, reach);
      const double v = r.uniform(-reach, reach);
      return cube.middle() + height * axis + u * a + v * b;
    };
    if (domain == Domain::Torus) {
      disc.centre = drawn.draw_centre(axis, disc.radius, least, least, candidate, rng);
    } else {
      do disc.centre = candidate(rng);
      while (glm::distance(disc.centre, cube.middle() + height * axis) > reach);
      if (!cube.contains(disc.centre)) continue;
    }
    drawn.insert(disc);
    disc.normal = draw_normal(set, rng);
    disc.ends = draw_end(set, rng);
    discs.push_back(disc);
  }
}

}  // namespace

std::vector<Disc> draw_discs(const JointPattern& pattern, double side, Seed seed, Domain domain) {
  check_pattern(pattern, side);
  std::vector<Disc> discs = discs_by_share(pattern, side, seed);
  for (std::size_t s = 0; s < pattern.sets.size(); ++s) {
    const JointSet& set = pattern.sets[s];
    if (!is_measured(set) || is_persistent(set)) continue;
    const std::vector<Disc> more = set.spacing > 0.0 ? discs_on_sheets(pattern, s, side, seed, domain)
                                                     : discs_by_intensity(pattern, s, side, seed, domain);
    discs.insert(discs.end(), more.begin(), more.end());
  }
  const std::vector<int> ages = joint_ages(pattern.sets);
  for (Disc& disc : discs)
    if (disc.set >= 0) disc.age = ages[static_cast<std::size_t>(disc.set)];
  for (Disc disc : pattern.discs_at) {
    disc.set = -1;
    disc.age = -1;
    disc.ends = false;
    discs.push_back(disc);
  }
  std::stable_sort(discs.begin(), discs.end(), [](const Disc& a, const Disc& b) {
    return a.age != b.age ? a.age < b.age : a.radius > b.radius;
  });
  return discs;
}

JointPattern in_tile_frame(JointPattern pattern, JointFrame frame, const Mat3& tile_from_frame) {
  for (JointSet& set : pattern.sets) {
    if (set.frame != frame) continue;
    set.frame = JointFrame::Tile;
    set.normal = glm::normalize(tile_from_frame * set.normal);
    for (Vec3& n : set.measured) n = glm::normalize(tile_from_frame * n);
  }
  return pattern;
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

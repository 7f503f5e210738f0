// What a joint pattern must hold: bounds, ages, closed blocks.
#include <algorithm>
#include <cmath>

#include "joint_laws.h"
#include "outcrop/core/error.h"
#include "outcrop/fracture/joints.h"

namespace outcrop {
namespace {

constexpr double kFinestGap = 1.0 / 1000;  // Of the side: as many joints along one line.
constexpr double kWidestDisc = 10.0;       // Of the side.
constexpr int kPowerSteps = 64;
constexpr double kIrregularToClose = 3.0;  // Irregular discs that are sure to close what sets leave open.

void check_set(const JointSet& set, double side) {
  const double length = glm::length(set.normal);
  require(std::abs(length - 1.0) < 1e-6, "normal", "a unit vector", length);
  require(std::isfinite(set.kappa) && set.kappa > 0.0, "kappa", "> 0 and finite", set.kappa);
  for (const Vec3& n : set.measured)
    require(std::abs(glm::length(n) - 1.0) < 1e-6, "measured", "unit vectors", glm::length(n));
  require(std::isfinite(set.share) && set.share >= 0.0, "share", "≥ 0 and finite", set.share);
  const bool has_spacing = set.spacing != 0.0;
  require(!has_spacing || (set.spacing >= kFinestGap * side && set.spacing <= side), "spacing",
          "in [side / 1000, side], or 0", set.spacing);
  require(set.spacing_cv > 0.0 && set.spacing_cv <= 5.0, "spacing_cv", "in (0, 5]", set.spacing_cv);
  require(set.persistence > 0.0 && set.persistence <= 4.0, "persistence", "in (0, 4]", set.persistence);
  require(std::isfinite(set.p32) && set.p32 >= 0.0 && set.p32 * side * kFinestGap <= 1.0, "p32",
          "in [0, 1000 / side]", set.p32);
  require(set.ends_share >= 0.0 && set.ends_share <= 1.0, "ends_share", "in [0, 1]", set.ends_share);
  if (is_persistent(set)) {
    require(is_measured(set), "spacing", "> 0, or a p32 > 0, for a persistent set", set.spacing);
    return;
  }
  require(set.radius_lo > 0.0, "radius_lo", "> 0", set.radius_lo);
  require(set.radius_hi >= set.radius_lo && set.radius_hi <= kWidestDisc * side, "radius_hi",
          "at least radius_lo, at most 10 sides", set.radius_hi);
  if (set.radius_law == RadiusLaw::PowerLaw)
    require(set.radius_exponent > 0.0 && set.radius_exponent <= 20.0, "radius_exponent", "in (0, 20]",
            set.radius_exponent);
  if (set.radius_law == RadiusLaw::Lognormal) {
    require(set.radius_mean >= set.radius_lo && set.radius_mean <= set.radius_hi, "radius_mean",
            "between radius_lo and radius_hi", set.radius_mean);
    require(set.radius_cv > 0.0 && set.radius_cv <= 5.0, "radius_cv", "in (0, 5]", set.radius_cv);
  }
}

void check_columns(const JointPattern& pattern, double side) {
  for (const ColumnTier& tier : pattern.columns) {
    require(tier.width >= side / 100.0 && tier.width <= side / 5.0, "width", "of columns in [side / 100, side / 5]",
            tier.width);
    require(tier.irregularity >= 0.0 && tier.irregularity <= 1.0, "irregularity", "in [0, 1]", tier.irregularity);
    require(std::isfinite(tier.height) && tier.height > 0.0, "height", "> 0 and finite", tier.height);
  }
}

}  // namespace

void check_pattern(const JointPattern& pattern, double side) {
  require(std::isfinite(side) && side > 0.0, "side", "> 0 and finite", side);
  require(pattern.discs >= 0 && pattern.discs <= 100'000, "discs", "in 0 … 100000", pattern.discs);
  require(pattern.irregular_share >= 0.0 && pattern.irregular_share <= 1.0, "irregular_share", "in [0, 1]",
          pattern.irregular_share);
  require(pattern.centre_spacing >= 0.0, "centre_spacing", "≥ 0", pattern.centre_spacing);
  require(pattern.covered_share >= 0.0 && pattern.covered_share <= 1.0, "covered_share", "in [0, 1]",
          pattern.covered_share);
  require(pattern.least_thickness >= 0.0 && pattern.least_thickness <= side / 4.0, "least_thickness",
          "in [0, side / 4]", pattern.least_thickness);
  require(pattern.least_angle >= 0.0 && pattern.least_angle <= kPi / 3.0, "least_angle", "in [0, π/3]",
          pattern.least_angle);
  check_columns(pattern, side);
  double shares = 0.0;
  bool by_share = pattern.sets.empty() && pattern.columns.empty() && pattern.discs_at.empty();
  for (const JointSet& set : pattern.sets) {
    check_set(set, side);
    if (is_measured(set)) continue;
    by_share = true;
    shares += set.share;
  }
  require(pattern.discs == 0 || !by_share || shares > 0.0, "share", "a sum > 0 over the joint sets", shares);
  for (const Disc& disc : pattern.discs_at) {
    require(std::abs(glm::length(disc.normal) - 1.0) < 1e-6, "normal", "a unit vector", glm::length(disc.normal));
    require(disc.radius > 0.0 && disc.radius <= kWidestDisc * side, "radius", "in (0, 10 sides]", disc.radius);
    for (int axis = 0; axis < 3; ++axis)
      require(std::isfinite(disc.centre[axis]), "centre", "finite", disc.centre[axis]);
  }
  (void)joint_ages(pattern.sets);
}

namespace {

// The sets that a set ends at; nothing for columns and unknown names.
std::vector<std::size_t> older_sets(const std::vector<JointSet>& sets, std::size_t s) {
  std::vector<std::size_t> older;
  for (const std::string& name : sets[s].ends_at)
    for (std::size_t i = 0; i < sets.size(); ++i)
      if (sets[i].name == name) older.push_back(i);
  return older;
}

// The age of a set, and of those on which it depends; nothing when the path leads back to itself, which ends it.
std::optional<int> find_age(const std::vector<JointSet>& sets, std::size_t s, std::vector<std::size_t>& path,
                            std::vector<int>& ages) {
  if (ages[s] >= 0) return ages[s];
  const bool is_cycle = std::find(path.begin(), path.end(), s) != path.end();
  path.push_back(s);
  if (is_cycle) return std::nullopt;
  int age = 0;
  for (const std::size_t older : older_sets(sets, s)) {
    const auto found = find_age(sets, older, path, ages);
    if (!found) return std::nullopt;
    age = std::max(age, *found + 1);
  }
  path.pop_back();
  return ages[s] = age;
}

}  // namespace

std::string termination_cycle(const std::vector<JointSet>& sets) {
  std::vector<int> ages(sets.size(), -1);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    std::vector<std::size_t> path;
    if (find_age(sets, s, path, ages)) continue;
    std::string cycle;
    for (auto at = std::find(path.begin(), path.end(), path.back()); at != path.end(); ++at)
      cycle += (cycle.empty() ? "\"" : " ends at \"") + sets[*at].name + "\"";
    return cycle;
  }
  return {};
}

std::vector<int> joint_ages(const std::vector<JointSet>& sets) {
  for (const JointSet& set : sets)
    for (const std::string& name : set.ends_at)
      require(name == kColumns || std::any_of(sets.begin(), sets.end(), [&](const JointSet& s) { return s.name == name; }),
              "ends_at", "the name of a joint set, or \"columns\"", "\"" + name + "\"");
  const std::string cycle = termination_cycle(sets);
  require(cycle.empty(), "ends_at", "sets of different age", "a cycle: " + cycle);
  std::vector<int> ages(sets.size(), -1);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    std::vector<std::size_t> path;
    (void)find_age(sets, s, path, ages);
  }
  return ages;
}

namespace {

// Σ n nᵀ / N of what the set's normals are on average. About the mean, cos² of a Fisher distribution is
// 1 − 2 (coth κ − 1/κ) / κ on average.
Mat3 mean_outer_product(const JointSet& set) {
  Mat3 sum{0.0};
  if (!set.measured.empty()) {
    for (const Vec3& n : set.measured)
      sum += glm::outerProduct(n, n) / static_cast<double>(set.measured.size());
    return sum;
  }
  const double k = set.kappa;
  const double along = k < 1e-3 ? 1.0 / 3.0 : 1.0 - 2.0 / k * (1.0 / std::tanh(k) - 1.0 / k);
  const double aside = 0.5 * (1.0 - along);
  return aside * Mat3(1.0) + (along - aside) * glm::outerProduct(set.normal, set.normal);
}

// The eigenvector of the greatest eigenvalue of a symmetric matrix without negative ones.
Vec3 first_eigenvector(Mat3 matrix) {
  for (int step = 0; step < kPowerSteps; ++step) {  // squares: 2^64 powers
    double most = 0.0;
    for (int c = 0; c < 3; ++c) most = std::max(most, glm::length(matrix[c]));
    if (most == 0.0) return {0, 0, 1};
    matrix = matrix / most;
    matrix = matrix * matrix;
  }
  int longest = 0;
  for (int c = 1; c < 3; ++c)
    if (glm::length(matrix[c]) > glm::length(matrix[longest])) longest = c;
  return glm::normalize(matrix[longest]);
}

}  // namespace

std::optional<Vec3> open_direction(const JointPattern& pattern) {
  const double least = std::pow(std::sin(radians(15.0)), 2);  // of cos² between the direction and the best set's normals
  Mat3 sum{0.0};
  std::vector<Mat3> parts;
  const auto add = [&](const Mat3& part) {
    parts.push_back(part);
    sum += part;
  };
  bool by_share = false;
  for (const JointSet& set : pattern.sets) {
    by_share = by_share || !is_measured(set);
    add(mean_outer_product(set));
  }
  if (!pattern.columns.empty()) add(Mat3(Vec3(0.5, 0, 0), Vec3(0, 0.5, 0), Vec3(0.0)));
  if (by_share && pattern.irregular_share * pattern.discs >= kIrregularToClose) add(Mat3(1.0 / 3.0));
  if (parts.empty()) return Vec3(0, 0, 1);
  // The least eigenvector is the first one of what is left to the trace.
  const double trace = sum[0][0] + sum[1][1] + sum[2][2];
  const Vec3 open = first_eigenvector(Mat3(trace) - sum);
  for (const Mat3& part : parts)
    if (glm::dot(open, part * open) >= least) return std::nullopt;
  return open.z < 0.0 ? -open : open;
}

}  // namespace outcrop

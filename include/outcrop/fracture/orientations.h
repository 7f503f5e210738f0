/// Orientations of joints: dip and dip direction, Fisher statistics of poles, and joint sets found in measurements.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "outcrop/core/vec.h"

namespace outcrop {

/// How a plane lies, as a compass measures it.
struct Orientation {
  double dip = 0.0;            ///< From the horizontal, radians, [0, π/2].
  double dip_direction = 0.0;  ///< Where the plane falls to, clockwise from north (y), radians, [0, 2π).
};

/// The plane's unit normal that points up (or level).
[[nodiscard]] Vec3 normal_of(const Orientation& orientation) noexcept;
/// The orientation of the plane across a normal; n and −n are the same plane. @param normal  Unit.
[[nodiscard]] Orientation orientation_of(const Vec3& normal) noexcept;

/// Statistics of axes (poles without a sign) under the Fisher distribution.
struct AxisStatistics {
  Vec3 mean{0, 0, 1};      ///< Unit, pointing up: the first eigenvector of Σ xxᵀ.
  double resultant = 0.0;  ///< R / N with all poles turned to the mean's side, [0, 1].
  double kappa = 0.0;      ///< κ̂ = (N − 1) / (N − R); 0 for fewer than two poles, infinite for equal ones.
  double count = 0.0;      ///< N, or the sum of the weights.
};

/// @param weights  Empty, or one a pole, ≥ 0 (areas, Terzaghi weights); they are scaled so that Σ w = (Σ w)² / Σ w²,
/// the number of poles that they are worth.
/// @throws ParameterError when there are weights, but not one a pole. Method: Fisher 1953, on axes after Watson 1966.
[[nodiscard]] AxisStatistics axis_statistics(std::span<const Vec3> poles, std::span<const double> weights = {});

/// How many joints of an orientation stand for one that a scan line meets: 1 / sin(angle between line and plane), the
/// angle being 15° at least. @cite terzaghi_1965
/// @param pole, line  Unit.
[[nodiscard]] double terzaghi_weight(const Vec3& pole, const Vec3& line) noexcept;

/// A joint set that was found in measured poles.
struct FoundSet {
  AxisStatistics statistics;           ///< Of its members.
  std::vector<std::uint32_t> members;  ///< Indices of poles, ascending.
};

struct FoundSets {
  std::vector<FoundSet> sets;  ///< The heaviest first.
  std::vector<int> set_of;     ///< Of each pole; −1: a random joint.
  double random_share = 0.0;   ///< Of the weight: joints without a set.
};

struct FindSetsOptions {
  int sets = 0;               ///< Wanted; 0: as many as the poles show, by the Bayesian information criterion.
  int most_sets = 8;          ///< At most, [1, 20].
  double least_share = 0.05;  ///< A set holds this share of the weight at least, when their number is found.
};

/// Parts poles into joint sets and random joints: a mixture of Fisher distributions of axes over a uniform background,
/// fitted by expectation maximisation; sets are added one by one, each where the poles that no set explains are
/// densest. Without random numbers, so the same poles give the same sets.
///
/// @param weights  Empty, or one a pole, ≥ 0.
/// @throws ParameterError for options outside their bounds, or weights that are not one a pole.
/// Cost: O(poles² + poles · sets² · 100). Method: Banerjee et al. 2005 for the concentration; the criterion is
/// Schwarz's.
[[nodiscard]] FoundSets find_joint_sets(std::span<const Vec3> poles, const FindSetsOptions& options = {},
                                        std::span<const double> weights = {});

/// Reads measured orientations: a line holds dip and dip direction in degrees, parted by a comma or blanks. Empty lines
/// and what follows a # are passed over; directions beyond a full turn are turned back, as field tables hold them.
/// @throws InputError `file:line: expected …, got …`, also when there is no measurement at all.
[[nodiscard]] std::vector<Orientation> read_orientations(const std::filesystem::path& path);
/// The same from text; `name` stands for the file in messages.
[[nodiscard]] std::vector<Orientation> parse_orientations(std::string_view text, std::string_view name);

}  // namespace outcrop

/// What joint sets are drawn by: orientations, spacings and radii; private to the stage.
#pragma once

#include <vector>

#include "outcrop/fracture/joints.h"

namespace outcrop {

/// Radius of persistent joints, in sides: beyond whatever a cell of the tile reaches to.
inline constexpr double kPersistentRadius = 1000.0;

/// The normal of one of the set's joints.
[[nodiscard]] Vec3 draw_normal(const JointSet& set, Rng& rng);

/// The radius of one of its discs.
[[nodiscard]] double draw_radius(const JointSet& set, Rng& rng);

/// How close the joints of a set may come, and how many stand in a period.
struct GapRule {
  double least = 0.0;  ///< The stress shadow, metres: laws begin there and keep their mean, so that they vary less.
  /// One: a period alone, with the number of joints nearest to what the mean gap asks for. Many: rounded at random, right
  /// on average.
  enum class Periods { One, Many } periods = Periods::One;
};

/// The mean distance between the set's joints, were all of them persistent: its spacing, or 1 / P32.
[[nodiscard]] double mean_gap(const JointSet& set) noexcept;

/// Positions in [0, period), one at least: gaps follow the law and add up to the period.
/// @param from_zero  The first stands at 0; else anywhere.
[[nodiscard]] std::vector<double> closed_positions(const JointSet& set, double period, const GapRule& rule,
                                                   bool from_zero, Rng& rng);

/// Positions in [−reach, reach) of a stationary sequence that goes on beyond: its phase is uniform.
[[nodiscard]] std::vector<double> open_positions(const JointSet& set, double reach, const GapRule& rule,
                                                 Rng& rng);

[[nodiscard]] inline bool is_persistent(const JointSet& set) noexcept {
  return set.radius_law == RadiusLaw::Persistent;
}

/// Whether the number of its joints follows from spacing or P32, not from a share.
[[nodiscard]] inline bool is_measured(const JointSet& set) noexcept { return set.spacing > 0.0 || set.p32 > 0.0; }

}  // namespace outcrop

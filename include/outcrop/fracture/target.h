/// Targets instead of parameters: rock is asked for by block volume, Jv or RQD, and its lengths follow.
#pragma once

#include <optional>
#include <string>

#include "outcrop/core/task.h"
#include "outcrop/fracture/tile.h"

namespace outcrop {

/// What is asked for; several at once may contradict each other.
struct RockTarget {
  std::optional<double> block_volume;  ///< Mean, m³, > 0.
  std::optional<double> jv;            ///< Volumetric joint count, 1/m, > 0.
  std::optional<double> rqd;           ///< Percent by 110 − 2.5 Jv, [0, 100]; 100 is taken as its sparsest sign, Jv 4.

  [[nodiscard]] bool any() const noexcept { return block_volume || jv || rqd; }
};

/// Options whose tile comes nearest to a target, and what it reaches.
struct TargetedTile {
  TileOptions options;
  double scale = 1.0;  ///< Of all lengths, from the options that came in.
  double block_volume = 0.0, jv = 0.0, rqd = 0.0;
  bool is_met = true;  ///< Block volume within 15 %, Jv within 10 % (RQD: as its Jv) of what was asked for.
  std::string note;    ///< One line: what was asked for and what is reached.
};

/// Scales a tile to a target: side, sample spacing, aperture, rounding and every length of its own pattern. Shapes and
/// counts of blocks stay: a tile scales exactly, so it is made once, measured and scaled. Where targets contradict each
/// other, the scale with the least sum of squared logarithmic errors is taken (of volumes' cube roots and of Jv).
/// @throws ParameterError for a target that is empty or out of its bounds, and as make_tile.
/// Cost: that of make_tile and measure_rock.
[[nodiscard]] TargetedTile fit_tile(const TileOptions& options, const RockTarget& target, Seed seed,
                                    const Task& task = {});

/// "block_volume 2.5 m³, jv 6 1/m": one line for people.
[[nodiscard]] std::string described(const RockTarget& target);

/// The options with all lengths multiplied; `factor` > 0.
[[nodiscard]] TileOptions scaled(TileOptions options, double factor);

}  // namespace outcrop

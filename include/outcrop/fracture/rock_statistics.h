/// Rock in numbers: what a made tile holds, measured as an engineering geologist would.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "outcrop/core/task.h"
#include "outcrop/fracture/orientations.h"
#include "outcrop/fracture/tile.h"

namespace outcrop {

/// One joint set of a tile, or a group of joints that belong to none.
struct SetStatistics {
  int set = -1;                ///< Index into Tile::sets; −1: random joints; or kAddedJoint, kColumnJoint, kTierJoint.
  std::string name;            ///< The set's, or "set 1", …, "random", "added", "columns", "tiers".
  std::size_t joints = 0;      ///< Discs that bound blocks; 0 for joints without discs.
  double p32 = 0.0;            ///< Area in a volume, 1/m: each face belongs to two blocks and counts half for each.
  AxisStatistics orientation;  ///< Of the joints as they cut, one vote each; of faces by area where there are no discs.
  /// Mean spacing along the mean normal t, metres: volume / Σ area |n · t|, what scan lines give when there are many;
  /// 0 for groups without a mean normal (random joints, columns).
  double spacing = 0.0;
  double scanned_spacing = 0.0;                 ///< The same from scan lines: scatters by a few percent.
  double spacing_cv = 0.0;                      ///< Standard deviation of those spacings over their mean.
  std::size_t spacings = 0;                     ///< How many were measured.
  double trace_mean = 0.0, trace_median = 0.0;  ///< On plane cuts as wide as the tile, metres; 0: none seen.
};

/// Sizes and shape of one block.
struct BlockMeasure {
  double volume = 0.0;            ///< m³.
  std::array<double, 3> sizes{};  ///< Longest, middle, shortest principal size, metres.
  int faces = 0;

  [[nodiscard]] double elongation() const noexcept { return sizes[0] / sizes[1]; }
  [[nodiscard]] double flatness() const noexcept { return sizes[1] / sizes[2]; }
};

/// D10, D50 and D90 of a distribution.
struct Quantiles {
  double d10 = 0.0, d50 = 0.0, d90 = 0.0;
};

struct RockStatistics {
  double side = 0.0;                 ///< Of the tile, metres.
  std::vector<SetStatistics> sets;   ///< The tile's sets in their order, then the other groups that bound blocks.
  std::vector<BlockMeasure> blocks;  ///< In the order of the tile's.
  double volume_mean = 0.0;          ///< m³.
  double volume_cv = 0.0;
  Quantiles volume_by_number;  ///< m³: a tenth of the blocks is smaller than d10, …
  Quantiles volume_by_volume;  ///< m³: a tenth of the rock is in blocks smaller than d10, …
  double faces_mean = 0.0;
  double elongation = 0.0;  ///< Geometric mean of the blocks'.
  double flatness = 0.0;
  double p32 = 0.0;   ///< Of all joints, 1/m.
  double jv = 0.0;    ///< Volumetric joint count, 1/m: Σ 1 / spacing, and P32 for joints without a set.
  double beta = 0.0;  ///< Mean block volume · Jv³.
  std::array<double, 3> joints_per_metre{};  ///< On lines along x, y and z.
  double rqd_2005 = 0.0, rqd_1982 = 0.0;     ///< From Jv, percent.
  double rqd_priest_hudson = 0.0;            ///< From the joints on vertical lines.
  double rqd_measured = 0.0;                 ///< Share of vertical lines in pieces of 10 cm and more, percent.
  double gap_share = 0.0;                    ///< Of the tile in cracks.
  double overlap_share = 0.0;                ///< Of the tile in two blocks or more.
};

/// Measures a tile. Nothing is taken from what was asked for but the names of the sets and which disc belongs to which.
///
/// Scan lines wrap around the tile and meet some 4000 joints a set (64 to 512 sides in all); areas are those of
/// faces of blocks without their cracks. Cost: O(blocks) for each side of a scan line; 30 ms for a tile of 100 blocks.
/// @throws ParameterError for a tile without blocks.
[[nodiscard]] RockStatistics measure_rock(const Tile& tile, const Task& task = {});

/// The statistics as a JSON object, as in `--report` and in tile reports. Format: docs/formats.md.
class JsonWriter;
void write_rock_statistics(JsonWriter& json, const RockStatistics& rock);

}  // namespace outcrop

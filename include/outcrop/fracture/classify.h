/// The type of a rock from what was made: an independent judge of the generator.
#pragma once

#include "outcrop/fracture/tile.h"

namespace outcrop {

/// What the faces and shapes of blocks say, and the type that follows.
struct Classification {
  BlockType type = BlockType::Equidimensional;
  double set_share = 0.0;     ///< Of the face area: within 20° of the three directions that hold most of it, [0, 1].
  double square_share = 0.0;  ///< The same for three directions at right angles.
  double prism_share = 0.0;   ///< Of the face area: within 20° of across or along one axis, as in columns.
  double elongation = 0.0;    ///< Geometric mean over blocks of longest over middle principal size.
  double fabric_elongation =
      0.0;  ///< Extents along the square directions, geometric means over blocks: longest over middle
  double fabric_flatness = 0.0;  ///< and middle over shortest: what blocks have in common.
};

/// Judges by blocks' planes, faces and hulls alone: no disc, set or option is looked at.
///
/// After Dearman 1991 and Palmström 2001: without three directions, columnar where blocks are long and their faces lie
/// along one axis or across it, else polyhedral; with them, tabular where blocks share their short side, prismatic
/// where they share their long one, rhombohedral where the directions are oblique, else equidimensional.
/// @throws ParameterError for a tile without blocks. Cost: O(blocks · faces), at most 2000 faces being looked at.
[[nodiscard]] Classification classify(const Tile& tile);

}  // namespace outcrop

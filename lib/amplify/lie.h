/// How the tiles of a strata file lie in the world.
#pragma once

#include "outcrop/amplify/strata_file.h"
#include "outcrop/core/vec.h"
#include "outcrop/fracture/tile.h"

namespace outcrop {

struct Lie {
  Mat3 world_from_bedding{1.0}, bedding_from_tile{1.0};

  [[nodiscard]] Mat3 world_from_tile() const { return world_from_bedding * bedding_from_tile; }
};

/// Bedding dips as the strata do; the lattice is turned about its normal.
[[nodiscard]] Lie lie_of(const StrataFile& file);

/// As tile_options, with joint sets that were measured on the map, or in its beds, turned into the tile.
[[nodiscard]] TileOptions tile_options(const RockMaterial& material, double default_side, const Lie& lie);

}  // namespace outcrop

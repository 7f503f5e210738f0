/// How copies of a tile's regions fill space, in a lattice or without a period.
#pragma once

#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/core/vec.h"

namespace outcrop {

/// Flat walls part space into slabs, slabs into layers that lie on each other, a layer into parallel rods, and a rod
/// repeats along its axis. A region is what a rod holds of one period.
///
/// Since the walls between slabs, layers and rods are flat, nothing opens when a layer slides in its plane or a rod along
/// its axis, nor when a slab, a rod or a copy is a little longer than the others; and a copy of a region may hold the blocks
/// of any variant, since all have the same walls. So when `slides` is set, each layer and rod has an offset, each slab, rod
/// and copy a size, and each copy a variant of its own, all hashed from the seed and the copy's numbers, layers lie on each
/// other in an order that changes from slab to slab, each turned a little, and nothing repeats.
struct TileLayout {
  struct Layer {
    double floor = 0.0;       ///< Of the base copy, metres along `normal`.
    double thickness = 20.0;  ///< Metres; those of all layers sum to `pitch`.
    Vec3 side_normal{0, 1, 0};  ///< Of the walls between rods, unit.
    double side_offset = 0.0;   ///< Of the base rod's first wall, metres along it.
    double side_pitch = 20.0;   ///< Metres along it from one wall to the next.
    Vec3 axis{1, 0, 0};         ///< Of the rods, unit; at right angles to both normals.
    double period = 20.0;       ///< Metres along the axis.
    Vec3 end_normal{1, 0, 0};   ///< Of the walls between the copies in a rod, unit, up the axis.
    double end_offset = 0.0;    ///< Of the base copy's first, metres along it.
  };

  Vec3 normal{0, 0, 1};  ///< Of the walls between slabs, unit.
  double pitch = 20.0;   ///< Thickness of a slab, metres.
  std::vector<Layer> layers = std::vector<Layer>(1);
  bool slides = false;      ///< False: the tile's lattice.
  bool whole_rods = false;  ///< All of a rod is of one variant: its blocks go through from copy to copy.
  bool level = false;       ///< Rods do not slide along their axis: heights along it mean something.
  Seed seed = 0;            ///< Of the hashes.

  /// Cubes of `side` metres: the tile's lattice.
  [[nodiscard]] static TileLayout lattice(double side) {
    TileLayout layout{.pitch = side};
    layout.layers[0].thickness = layout.layers[0].side_pitch = layout.layers[0].period = side;
    return layout;
  }
};

}  // namespace outcrop

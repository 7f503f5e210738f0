/// Bounds of patches gathered into coarser and coarser levels, so that any rectangle is answered by a few of them.
#pragma once

#include <vector>

#include "bicubic.h"

namespace outcrop::terrain {

/// A mip pyramid of PatchBounds over a grid of `width` x `height` patches.
class Pyramid {
 public:
  Pyramid() = default;
  /// @param patches  Row-major, width · height of them.
  Pyramid(int width, int height, std::vector<PatchBound> patches);

  /// Holds in all patches of columns [c0, c1] and rows [r0, r1], which lie in the grid. Cost: at most 16 nodes.
  [[nodiscard]] PatchBound bound(int c0, int c1, int r0, int r1) const noexcept;

 private:
  struct Level {
    int width;
    std::vector<PatchBound> nodes;
  };
  std::vector<Level> levels_;  ///< Finest first; the last has at most 4 x 4 nodes.
};

}  // namespace outcrop::terrain

/// Distances on a raster.
#pragma once

#include <vector>

#include "outcrop/core/vec.h"

namespace outcrop {

/// Exact Euclidean distance of each node of a width · height raster to the nearest one that is marked, at most `farthest`
/// (which may be infinite). Row-major; `cell` is the distance between neighbours along a row and along a column.
///
/// Cost: O(nodes). For float and double. Method: Felzenszwalb and Huttenlocher 2012, lower envelopes of parabolas.
template <class Real>
[[nodiscard]] std::vector<Real> distance_to_marked(int width, int height, const Vec2& cell, const std::vector<char>& marked,
                                                   Real farthest);

}  // namespace outcrop

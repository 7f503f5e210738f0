/// Distances on a raster.
#pragma once

#include <functional>
#include <vector>

namespace outcrop {

/// Exact Euclidean distance of each node of a width · height raster to the nearest one that is marked, in steps of the raster;
/// `farthest` where none is that near. Row-major.
///
/// Cost: O(nodes). Method: Felzenszwalb and Huttenlocher 2012, lower envelopes of parabolas, columns then rows.
[[nodiscard]] std::vector<float> distance_to_marked(int width, int height, const std::vector<char>& marked, float farthest);

}  // namespace outcrop

/// Whether a mesh from a file is closed, however its vertices are split.
#pragma once

#include <cstddef>

#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop {

/// Edges that an odd number of triangles shares, whichever way they turn; vertices at one place count as one.
/// Cost: O(n log n).
[[nodiscard]] std::size_t count_open_edges(const TriangleMesh& mesh);

}  // namespace outcrop

/// A judge of meshes that is not ours.
#pragma once

#include <cstddef>

#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop::test {

/// Pairs of triangles that meet elsewhere than in the vertices and edges they share: CGAL's exact predicates on float
/// positions. Cost: O(n log n). @throws std::runtime_error when the triangles are no manifold.
[[nodiscard]] std::size_t self_intersections(const TriangleMesh& mesh);

}  // namespace outcrop::test

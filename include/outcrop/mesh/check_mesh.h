/// Questions to a mesh: is it closed, oriented, in one piece?
#pragma once

#include <cstddef>

#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop {

struct MeshCheck {
  std::size_t vertices = 0, triangles = 0;
  std::size_t open_edges = 0;            ///< Directed edges without their opposite.
  std::size_t nonmanifold_edges = 0;     ///< Directed edges used more than once.
  std::size_t nonmanifold_vertices = 0;  ///< Vertices whose triangles form more than one fan.
  std::size_t degenerate_triangles = 0;  ///< Two equal indices or zero area.
  std::size_t parts = 0;
  long long euler = 0;  ///< V − E + F over used vertices.
  double volume = 0.0;  ///< Signed, m³; meaningful when closed.
  double area = 0.0;
  [[nodiscard]] bool closed() const noexcept { return open_edges == 0 && nonmanifold_edges == 0; }
};

/// Cost: O(n log n).
[[nodiscard]] MeshCheck check_mesh(const TriangleMesh& mesh);

}  // namespace outcrop

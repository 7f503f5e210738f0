/// The searched case table of marching cubes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "outcrop/core/vec.h"

namespace outcrop {

/// An edge of the unit cube: it starts at the corner `from` and runs one unit along `axis`.
struct CubeEdge {
  int axis;
  IVec3 from;
};

inline constexpr int kCubeEdges = 12;

/// Edges 4a to 4a + 3 run along axis a; the rest of the number is the place on the next axis and twice that on the
/// last.
[[nodiscard]] constexpr CubeEdge cube_edge(int edge) noexcept {
  const int axis = edge / 4;
  IVec3 from{0};
  from[(axis + 1) % 3] = edge & 1;
  from[(axis + 2) % 3] = (edge >> 1) & 1;
  return {axis, from};
}

/// True when both edges touch one face of the cube: a segment between them would lie in that face.
[[nodiscard]] bool share_cube_face(int edge_a, int edge_b) noexcept;

/// A triangle whose corners lie on three edges of the cube, counter-clockwise seen from the air.
using CubeTriangle = std::array<std::uint8_t, 3>;

/// The triangles of all 256 cases; bit x + 2y + 4z of a case is set when that corner is rock.
///
/// Each face of the cube joins its crossing edges by the face's corners alone, and where a face is ambiguous its rock
/// corners are cut off one by one, so that two cells that share a face draw the same segments on it. The segments form
/// loops; each loop is filled by the triangulation of least area through the edges' middles among those of which no
/// diagonal lies in a face of the cube. So each face carries its segments and nothing else, and the surfaces of
/// neighbouring cells close. That the triangles of one cell never intersect is tested for random places on the edges.
/// Method: Lorensen and Cline 1987, with a table that is searched, not drawn.
class CubeCases {
 public:
  /// The one table; built on first use.
  [[nodiscard]] static const CubeCases& table();
  [[nodiscard]] std::span<const CubeTriangle> operator[](int cube_case) const noexcept {
    return {triangles_.data() + first_[cube_case], triangles_.data() + first_[cube_case + 1]};
  }

 private:
  CubeCases();
  std::vector<CubeTriangle> triangles_;
  std::array<std::uint16_t, 257> first_{};
};

}  // namespace outcrop

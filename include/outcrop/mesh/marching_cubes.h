/// The searched case tables of marching cubes: for cubes, and for the pyramids and tetrahedra of cells beside finer
/// ones.
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

/// The corners of a face of the unit cube, counter-clockwise seen from outside; side 0 is the low one.
[[nodiscard]] std::array<IVec3, 4> cube_face(int axis, int side) noexcept;

/// A convex solid whose corners are rock or air.
struct CellShape {
  std::vector<Vec3> corners;
  std::vector<std::array<std::uint8_t, 2>> edges;  ///< Corners.
  std::vector<std::vector<std::uint8_t>> faces;    ///< Corners, counter-clockwise seen from outside.

  /// True when both edges bound one face: a segment between them would lie in that face.
  [[nodiscard]] bool share_face(int edge_a, int edge_b) const noexcept;

  [[nodiscard]] static CellShape cube();         ///< Corner x + 2y + 4z; edges as cube_edge.
  [[nodiscard]] static CellShape pyramid();      ///< Corners 0 to 3: a unit square from below; 4: half a unit above.
  [[nodiscard]] static CellShape tetrahedron();  ///< Corners 0, 1, 2 counter-clockwise seen from outside.
};

/// A triangle whose corners lie on three edges of the shape, counter-clockwise seen from the air.
using CellTriangle = std::array<std::uint8_t, 3>;

/// The triangles of all cases of a shape; bit i of a case is set when corner i is rock.
///
/// Each face joins its crossing edges by the face's corners alone, and where a square face is ambiguous its rock corners
/// are cut off one by one, so that two cells that share a face draw the same segments on it. The segments form loops;
/// each loop is filled by the triangulation of least area through the edges' middles among those of which no diagonal
/// lies in a face. So each face carries its segments and nothing else, and the surfaces of neighbouring cells close.
/// That the triangles of one cell never intersect is tested for random places on the edges. Method: Lorensen and
/// Cline 1987, with tables that are searched, not drawn.
class CaseTable {
 public:
  explicit CaseTable(const CellShape& shape);
  [[nodiscard]] std::span<const CellTriangle> operator[](int cell_case) const noexcept {
    return {triangles_.data() + first_[cell_case], triangles_.data() + first_[cell_case + 1]};
  }

  /// The one table of each shape; built on first use.
  [[nodiscard]] static const CaseTable& cube();
  [[nodiscard]] static const CaseTable& pyramid();
  [[nodiscard]] static const CaseTable& tetrahedron();

 private:
  std::vector<CellTriangle> triangles_;
  std::vector<std::uint16_t> first_;
};

}  // namespace outcrop

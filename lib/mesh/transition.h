/// Cells beside finer ones: cut into pyramids and tetrahedra around their centres.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "brick_tree.h"
#include "lattice.h"

namespace outcrop::meshing {

/// Nodes of a brick and the middles between them: 0 to 16 an axis.
inline constexpr int kHalves = 2 * kBrickCells + 1;

/// A half node as a number; numbers compare as (z, y, x) do.
[[nodiscard]] constexpr int half_number(const IVec3& half) noexcept {
  return half.x + kHalves * (half.y + kHalves * half.z);
}
[[nodiscard]] constexpr IVec3 half_place(int number) noexcept {
  return {number % kHalves, number / kHalves % kHalves, number / (kHalves * kHalves)};
}

/// An edge of a piece, as its two half nodes, the lower number first.
using HalfEdge = std::array<int, 2>;

/// The surface in the cells of one brick that share a face or an edge with finer cells.
///
/// Such a cell is the union of cones from its centre over its faces. A face shared with finer cells is four squares,
/// and carries four pyramids; a face with a divided edge is a fan of triangles around its middle, and carries
/// tetrahedra; any other face is one square and carries one pyramid. Both cells that share a face cut it alike, so what
/// they draw on it is the same; each piece is convex, so what is in different pieces does not meet. Where the nodes
/// around a middle agree, it counts as one of them.
class TransitionCells {
 public:
  TransitionCells();
  /// Finds those cells and samples them. `values` are the brick's; `field` is narrowed to it.
  /// @return true when one of them holds rock and air.
  bool sample(const Lattice& lattice, const Field& field, const Brick& brick, const BrickValues& values,
              const FinerCells& finer);
  /// Is this one of those cells? node = i + 9 j + 81 k.
  [[nodiscard]] bool is_coned(int node) const noexcept { return coned_[node] != 0; }
  /// Is the brick's edge from node (i, j, k) in two halves? Bit i of the row.
  [[nodiscard]] unsigned divided(int axis, int j, int k) const noexcept { return divided_[(axis * 9 + k) * 9 + j]; }
  [[nodiscard]] double at(int half) const noexcept { return values_[half]; }
  [[nodiscard]] std::size_t evaluations() const noexcept { return evaluations_; }

  /// How many of those cells hold rock and air.
  [[nodiscard]] std::size_t size() const noexcept { return mixed_.size(); }
  /// Where such a cell is in the brick.
  [[nodiscard]] const IVec3& place(std::size_t cell) const noexcept { return mixed_[cell].place; }
  /// Calls emit(edge, edge, edge) for each triangle of a cell, counter-clockwise seen from the air.
  template <class Emit>
  void for_each_triangle(std::size_t cell, Emit&& emit) const {
    for (std::size_t i = first_piece_[cell]; i < first_piece_[cell + 1]; ++i) emit_piece(pieces_[i], emit);
  }

 private:
  struct Piece {
    std::array<int, 5> corners;  ///< Half nodes; those of a tetrahedron are four.
    bool tetrahedron;
  };
  struct Cell {
    IVec3 place;
    int half;        ///< Of its first corner.
    unsigned finer;  ///< FinerCells::around.
    bool rock, air;  ///< What it is known to hold.
  };
  /// A face of a coned cell: half nodes counter-clockwise from outside, and the middles between each and the next.
  struct FaceNodes {
    std::array<int, 4> corners, middles;
    std::array<bool, 4> divided;
    int centre;
    bool finer;  ///< Shared with finer cells.
    [[nodiscard]] bool fan() const noexcept {
      return !finer && (divided[0] || divided[1] || divided[2] || divided[3]);
    }
  };
  /// What is known of a half node that is not a corner.
  enum class Known : std::uint8_t { Nothing, Sign, Value };

  void find_cells(const Lattice& lattice, const Field& field, const Brick& brick, const BrickValues& values,
                  const FinerCells& finer);
  void evaluate(const Lattice& lattice, const Field& field, const Brick& brick);
  template <class Visit>
  static void for_each_face(const Cell& cell, Visit&& visit);
  /// Calls visit(half node, corners) for the half nodes of the cell that finer cells have, too.
  template <class Visit>
  static void for_each_shared(const Cell& cell, Visit&& visit);
  template <class Visit>
  static void for_each_piece(const Cell& cell, Visit&& visit);
  void want(int half);
  [[nodiscard]] bool is_mixed(const FaceNodes& face) const;
  template <class Emit>
  void emit_piece(const Piece& piece, Emit&& emit) const;

  std::vector<double> values_, x_, y_, z_, f_;
  std::vector<Known> known_;
  std::vector<std::uint8_t> coned_;
  std::array<std::uint16_t, 3 * 81> divided_{};
  std::vector<Cell> cells_, mixed_;
  std::vector<int> missing_;
  std::vector<std::pair<int, int>> unmixed_;  ///< Middles of faces, each with a corner.
  std::vector<Piece> pieces_;
  std::vector<std::size_t> first_piece_;  ///< Of each mixed cell.
  std::size_t evaluations_ = 0;
};

/// The triangles of a piece whose corners are rock as the bits of `rock` say, as pairs of corners.
struct PieceTriangle {
  std::array<std::array<std::uint8_t, 2>, 3> edges;
};
[[nodiscard]] std::span<const PieceTriangle> piece_triangles(bool tetrahedron, unsigned rock);

template <class Emit>
void TransitionCells::emit_piece(const Piece& piece, Emit&& emit) const {
  unsigned rock = 0;
  for (int i = 0; i < (piece.tetrahedron ? 4 : 5); ++i) rock |= (values_[piece.corners[i]] < 0.0 ? 1u : 0u) << i;
  for (const PieceTriangle& t : piece_triangles(piece.tetrahedron, rock)) {
    std::array<HalfEdge, 3> edges;
    for (int i = 0; i < 3; ++i) {
      const int a = piece.corners[t.edges[i][0]], b = piece.corners[t.edges[i][1]];
      edges[i] = {std::min(a, b), std::max(a, b)};
    }
    emit(edges[0], edges[1], edges[2]);
  }
}

}  // namespace outcrop::meshing

/// The integer lattice that a region is meshed on, its bricks of 8³ cells, and the descent to those that matter.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop::meshing {

inline constexpr int kBrickCells = 8;
inline constexpr int kBrickNodes = kBrickCells + 1;
/// Positions are floats relative to the region's corner: with more cells an axis a vertex could round onto its node.
inline constexpr int kMaxCells = 1 << 17;

/// Nodes at lo + index · step. The one place where indices become metres, so that all who share a node share its bits.
struct Lattice {
  Vec3 lo{0.0};
  double step = 1.0;
  IVec3 cells{0};

  /// The lattice of a region; @throws ParameterError naming what is wrong with region or resolution.
  static Lattice over(const PolygonizeOptions& options);

  [[nodiscard]] double coordinate(int axis, double index) const noexcept { return lo[axis] + index * step; }
  [[nodiscard]] Vec3 node(const IVec3& index) const noexcept {
    return {coordinate(0, index.x), coordinate(1, index.y), coordinate(2, index.z)};
  }
  /// Relative to `lo`, as meshes store it.
  [[nodiscard]] float local(double index) const noexcept { return static_cast<float>(index * step); }
  [[nodiscard]] IVec3 bricks() const noexcept { return (cells + (kBrickCells - 1)) / kBrickCells; }
  /// The box of the octree cell `index` that spans 2^level bricks a side, cut off at the lattice's end.
  [[nodiscard]] Box box(const IVec3& index, int level) const noexcept;
};

/// A cell of the octree over bricks that may hold the surface, with a field that is equal to the scene's in it.
struct Cell {
  IVec3 index{0};  ///< In units of 2^level bricks.
  FieldPtr field;  ///< Of the parent: narrowed only when somebody looks into the cell.
};

/// The smallest level at which one cell spans the lattice.
[[nodiscard]] int root_level(const Lattice& lattice) noexcept;

/// The root cell, or none when the bound says that no surface is in it.
[[nodiscard]] std::vector<Cell> root_cells(const Lattice& lattice, const Field& field);

/// The up to eight children, in Morton order, of a cell at `level` > 0 that the bound cannot exclude.
[[nodiscard]] std::vector<Cell> split(const Lattice& lattice, const Cell& cell, int level);

/// Which of a brick's 9³ nodes are rock, and the edges between rock and air.
///
/// A node is rock where f < 0; f = 0 counts as air. Rows run along x: bit i of a row is node or edge i.
struct Brick {
  IVec3 index{0};                  ///< In bricks.
  IVec3 cells{0};                  ///< 1 to 8 an axis; less than 8 only at the lattice's end.
  IVec3 owned{0};                  ///< Nodes an axis whose edges are this brick's: 8, one more at the lattice's end.
  std::uint64_t first_vertex = 0;  ///< Of the vertices on its own edges, which follow each other row by row.
  std::uint64_t first_triangle = 0;
  std::array<std::uint16_t, kBrickNodes * kBrickNodes> rock{};
  std::array<std::uint16_t, 3 * kBrickNodes * kBrickNodes> rank{};  ///< Own vertices before the row (axis, k, j).

  Brick() = default;
  Brick(const Lattice& lattice, const IVec3& brick_index);

  [[nodiscard]] static constexpr int row(int axis, int j, int k) noexcept { return (axis * 9 + k) * 9 + j; }
  /// Bit i is set when the edge from node (i, j, k) along `axis` joins rock and air; j, k and the edge inside the
  /// brick.
  [[nodiscard]] unsigned crossing(int axis, int j, int k) const noexcept {
    const unsigned here = rock[k * 9 + j];
    if (axis == 0) return (here ^ (here >> 1)) & ((1u << cells.x) - 1);
    return here ^ (axis == 1 ? rock[k * 9 + j + 1] : rock[(k + 1) * 9 + j]);
  }
  /// Vertices on own edges in front of the edge (axis, i, j, k).
  [[nodiscard]] unsigned vertices_before(int axis, int i, int j, int k) const noexcept {
    return rank[row(axis, j, k)] + std::popcount(crossing(axis, j, k) & ((1u << i) - 1));
  }

  /// Calls visit(axis, j, k, mask) for each row of edges from nodes below `nodes`; mask has a bit for each such edge.
  template <class Visit>
  void for_each_row(const IVec3& nodes, Visit&& visit) const {
    for (int axis = 0; axis < 3; ++axis) {
      const unsigned mask = (1u << (axis == 0 ? cells.x : nodes.x)) - 1;
      const int rows = axis == 1 ? cells.y : nodes.y, layers = axis == 2 ? cells.z : nodes.z;
      for (int k = 0; k < layers; ++k)
        for (int j = 0; j < rows; ++j) visit(axis, j, k, mask);
    }
  }
  /// Calls visit(node, cube_case) for each cell that holds both; node = i + 9 j + 81 k.
  template <class Visit>
  void for_each_mixed_cell(Visit&& visit) const {
    const unsigned mask = (1u << cells.x) - 1;
    for (int k = 0; k < cells.z; ++k) {
      for (int j = 0; j < cells.y; ++j) {
        const unsigned a = rock[k * 9 + j], b = rock[k * 9 + j + 1];
        const unsigned c = rock[k * 9 + 9 + j], d = rock[k * 9 + 9 + j + 1];
        const unsigned any = a | b | c | d, all = a & b & c & d;
        for (unsigned mixed = (any | any >> 1) & ~(all & all >> 1) & mask; mixed != 0; mixed &= mixed - 1) {
          const int i = std::countr_zero(mixed);
          visit(i + 9 * j + 81 * k,
                static_cast<int>((a >> i & 3) | (b >> i & 3) << 2 | (c >> i & 3) << 4 | (d >> i & 3) << 6));
        }
      }
    }
  }
};

/// The brick's 9³ values: evaluates, keeps them for the roots, and sets `Brick::rock`.
class BrickValues {
 public:
  BrickValues();
  /// @return true when the brick holds rock and air.
  bool sample(const Lattice& lattice, const Field& field, Brick& brick);
  [[nodiscard]] double at(int node) const noexcept { return values_[node]; }
  [[nodiscard]] static int count(const Brick& brick) noexcept {
    return (brick.cells.x + 1) * (brick.cells.y + 1) * (brick.cells.z + 1);
  }

 private:
  std::vector<double> x_, y_, z_, values_;
};

}  // namespace outcrop::meshing

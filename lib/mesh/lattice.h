/// The integer lattice that a region is meshed on, its bricks of 8³ cells on an octree, and the descent to those that
/// matter.
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
inline constexpr int kNodes = kBrickNodes * kBrickNodes * kBrickNodes;
/// From a node to the next along each axis, in a brick's arrays of 9³ values.
inline constexpr int kStride[3] = {1, kBrickNodes, kBrickNodes * kBrickNodes};
/// Positions are floats: with more cells an axis between them and the origin a vertex could round onto its node.
inline constexpr int kMaxCells = 1 << 17;

/// Nodes at lo + index · step. The one place where indices become metres, so that all who share a node share its bits.
///
/// Indices count cells of the finest size. A brick of level l has cells of 2^l times that; the middles of its cells,
/// faces and edges are nodes of the lattice, too.
struct Lattice {
  Vec3 lo{0.0};
  Vec3 step{1.0};
  IVec3 cells{0};    ///< A multiple of 2^coarsest.
  Vec3 origin{0.0};  ///< What the mesh's positions are relative to.
  int coarsest = 0;  ///< Largest level of a brick; 0: uniform cells.

  /// The lattice of a region; @throws ParameterError naming what is wrong with region, resolution or tolerance.
  static Lattice over(const PolygonizeOptions& options);

  [[nodiscard]] double coordinate(int axis, double index) const noexcept { return lo[axis] + index * step[axis]; }
  [[nodiscard]] Vec3 place(const Vec3& index) const noexcept {
    return {coordinate(0, index.x), coordinate(1, index.y), coordinate(2, index.z)};
  }
  [[nodiscard]] Vec3 node(const IVec3& index) const noexcept { return place(Vec3(index)); }
  /// Relative to `origin`, as meshes store it.
  [[nodiscard]] float local(int axis, double index) const noexcept {
    return static_cast<float>(index * step[axis] + (lo[axis] - origin[axis]));
  }
  [[nodiscard]] Vec3f local(const Vec3& index) const noexcept {
    return {local(0, index.x), local(1, index.y), local(2, index.z)};
  }
  [[nodiscard]] IVec3 bricks() const noexcept { return (cells + (kBrickCells - 1)) / kBrickCells; }
  /// The box of the octree cell `index` that spans 2^level bricks a side, cut off at the lattice's end.
  [[nodiscard]] Box box(const IVec3& index, int level) const noexcept;
  /// Does that octree cell begin inside the lattice?
  [[nodiscard]] bool holds(const IVec3& index, int level) const noexcept {
    const IVec3 first = index * (kBrickCells << level);
    return index.x >= 0 && index.y >= 0 && index.z >= 0 && first.x < cells.x && first.y < cells.y && first.z < cells.z;
  }
};

/// A cell of the octree over bricks that may hold the surface, with a field that is equal to the scene's in it.
struct Cell {
  IVec3 index{0};  ///< In units of 2^level bricks.
  FieldPtr field;  ///< Of the parent: narrowed only when somebody looks into the cell.
};

/// The smallest level at which one cell spans the lattice.
[[nodiscard]] int root_level(const Lattice& lattice) noexcept;

/// False when the bound says that no surface is in the box.
[[nodiscard]] bool may_hold_surface(const Field& field, const Box& box);

/// The root cell, or none when the bound says that no surface is in it.
[[nodiscard]] std::vector<Cell> root_cells(const Lattice& lattice, const Field& field);

/// The index of child `octant` = x + 2y + 4z of an octree cell.
[[nodiscard]] inline IVec3 child_index(const IVec3& index, int octant) noexcept {
  return 2 * index + IVec3(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
}

/// The up to eight children, in Morton order, of a cell at `level` > 0 that the bound cannot exclude; `narrowed` is
/// the field in that cell.
[[nodiscard]] std::vector<Cell> children(const Lattice& lattice, const IVec3& index, int level,
                                         const FieldPtr& narrowed);
/// The same, narrowing the cell's field first.
[[nodiscard]] std::vector<Cell> split(const Lattice& lattice, const Cell& cell, int level);

/// Which of a brick's 9³ nodes are rock, and the edges between rock and air.
///
/// A node is rock where f < 0; f = 0 counts as air. Rows run along x: bit i of a row is node or edge i.
struct Brick {
  IVec3 index{0};  ///< In bricks of its level.
  int level = 0;
  IVec3 cells{0};  ///< 1 to 8 an axis; less than 8 only at the lattice's end.
  std::array<std::uint16_t, kBrickNodes * kBrickNodes> rock{};

  Brick(const Lattice& lattice, const IVec3& brick_index, int brick_level);

  /// The lattice index of its first node.
  [[nodiscard]] IVec3 first() const noexcept { return index * (kBrickCells << level); }

  /// Bit i is set when the edge from node (i, j, k) along `axis` joins rock and air; j, k and the edge inside the
  /// brick.
  [[nodiscard]] unsigned crossing(int axis, int j, int k) const noexcept {
    const unsigned here = rock[k * 9 + j];
    if (axis == 0) return (here ^ (here >> 1)) & ((1u << cells.x) - 1);
    return here ^ (axis == 1 ? rock[k * 9 + j + 1] : rock[(k + 1) * 9 + j]);
  }
  /// Calls visit(axis, j, k, crossing) for each row of edges.
  template <class Visit>
  void for_each_row(Visit&& visit) const {
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k <= cells.z - (axis == 2); ++k)
        for (int j = 0; j <= cells.y - (axis == 1); ++j) visit(axis, j, k, crossing(axis, j, k));
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
  /// The same with values that another took from the same brick.
  bool use(const std::vector<double>& values, Brick& brick);
  [[nodiscard]] const std::vector<double>& all() const noexcept { return values_; }
  /// At node i + 9 j + 81 k.
  [[nodiscard]] double at(int node) const noexcept { return values_[node]; }
  [[nodiscard]] static std::size_t count(const Brick& brick) noexcept {
    return static_cast<std::size_t>((brick.cells.x + 1) * (brick.cells.y + 1) * (brick.cells.z + 1));
  }

 private:
  bool classify(Brick& brick) const;

  std::vector<double> x_, y_, z_, values_;
};

}  // namespace outcrop::meshing

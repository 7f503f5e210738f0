/// The integer lattice that a region is meshed on, its bricks of 8³ cells on an octree, and the descent to those that
/// matter.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "node_set.h"
#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop::meshing {

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

/// Where |f| is larger than this, nothing within `distance` is on the other side of the surface: by the Lipschitz
/// constant or the modulus, whichever says more.
[[nodiscard]] double clear_value(const Field& field, double distance) noexcept;

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
/// A node is rock where f < 0; f = 0 counts as air.
struct Brick {
  IVec3 index{0};  ///< In bricks of its level.
  int level = 0;
  IVec3 cells{0};  ///< 1 to 8 an axis; less than 8 only at the lattice's end.
  BrickShape shape;
  NodeSet rock;

  Brick(const Lattice& lattice, const IVec3& brick_index, int brick_level);

  /// The lattice index of its first node.
  [[nodiscard]] IVec3 first() const noexcept { return index * (kBrickCells << level); }

  /// The nodes at which an edge along `axis` starts that joins rock and air.
  [[nodiscard]] NodeSet crossings(int axis) const noexcept {
    return (rock ^ rock.before(kStride[axis])) & shape.edges[axis];
  }
  /// Calls visit(axis, j, k, crossing) for each row of edges along x; bit i of `crossing` is the edge from (i, j, k).
  template <class Visit>
  void for_each_row(Visit&& visit) const {
    for (int axis = 0; axis < 3; ++axis) {
      const NodeSet crossing = crossings(axis);
      for (int k = 0; k <= cells.z - (axis == 2); ++k)
        for (int j = 0; j <= cells.y - (axis == 1); ++j) visit(axis, j, k, crossing.from(9 * j + 81 * k) & 0x1FFu);
    }
  }
  /// Calls visit(node, cube_case) for each cell that holds both; node = i + 9 j + 81 k.
  template <class Visit>
  void for_each_mixed_cell(Visit&& visit) const {
    NodeSet any = rock, all = rock;
    for (const int stride : kStride) {
      any = any | any.before(stride);
      all = all & all.before(stride);
    }
    ((any ^ all) & shape.cells).for_each([&](int node) {
      const unsigned below = rock.from(node), above = rock.from(node + 81);
      visit(node,
            static_cast<int>((below & 3) | (below >> 9 & 3) << 2 | (above & 3) << 4 | (above >> 9 & 3) << 6));
    });
  }
};

/// The brick's 9³ values: evaluates, keeps them for the roots, and sets `Brick::rock`.
class BrickValues {
 public:
  BrickValues();
  /// @param parent  The values of the brick twice as large around this one, if they are known: nodes that both have,
  ///                one in eight, are not computed again.
  /// @return true when the brick holds rock and air.
  bool sample(const Lattice& lattice, const Field& field, Brick& brick, std::span<const double> parent = {});
  /// The same with values that another took from the same brick.
  bool use(const std::vector<double>& values, Brick& brick);
  [[nodiscard]] const std::vector<double>& all() const noexcept { return values_; }
  /// At node i + 9 j + 81 k.
  [[nodiscard]] double at(int node) const noexcept { return values_[node]; }
  /// Values that were computed for the brick sampled last.
  [[nodiscard]] std::size_t evaluations() const noexcept { return evaluations_; }

 private:
  bool sample_between(const Lattice& lattice, const Field& field, Brick& brick, std::span<const double> parent);
  bool classify(Brick& brick) const;

  std::size_t evaluations_ = 0;
  std::vector<double> x_, y_, z_, values_;
};

}  // namespace outcrop::meshing

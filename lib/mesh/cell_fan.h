/// A vertex inside a cell: the triangles of the cell become a fan around it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lattice.h"
#include "roots.h"

namespace outcrop::meshing {

/// The one simple polygon that bounds oriented triangles, in their direction; empty when there is none, or several, or
/// more triangles than a cell has.
[[nodiscard]] std::vector<std::uint32_t> boundary_loop(std::span<const std::array<std::uint32_t, 3>> triangles);

/// Vertices inside cells whose surface is bounded by one polygon on the cell's faces.
///
/// The vertex minimises the squared distances to the tangent planes at the polygon's corners, so that it comes to lie
/// on a crease, and is moved onto the surface (extended marching cubes, @cite kobbelt_2001; tangent planes
/// @cite ju_2002). A fan around it is taken only if, seen along the polygon's normal, each of its triangles clearly
/// turns the same way and all turn once around: it is a graph, and no two triangles meet but at their common edges. The
/// vertex keeps away from the cell's faces, so what is in different cells does not meet either, and the polygon itself
/// stays as it is.
class CellFans {
 public:
  struct Fan {
    Vec3f position;  ///< As Lattice::local.
    Vec3 gradient;   ///< Of the field; one-sided on a crease.
    Vec3 up;         ///< Normal of the polygon; the fan is a graph over the plane across it.
    bool crease;     ///< Normals around it differ.
    bool taken = false;
  };

  void clear();
  /// A cell from the node `first`, `edge` cells long.
  /// @param loop       Its polygon: vertices, counter-clockwise seen from the air.
  /// @param triangles  What the fan would replace: it is taken where the surface has a crease, and only when they are
  ///                   off by more than `tolerance` and the fan by less than half of that. Empty: it is taken where the
  ///                   surface has no crease, or when it is off by less than `tolerance`.
  void add(const IVec3& first, int edge, std::span<const std::uint32_t> loop,
           std::span<const std::array<std::uint32_t, 3>> triangles, double tolerance);
  /// Decides on all cells. `positions` and unit `normals` by vertex. @return field values computed.
  std::size_t solve(const Lattice& lattice, const Field& field, std::span<const Vec3f> positions,
                    std::span<const Vec3f> normals);

  [[nodiscard]] std::size_t size() const noexcept { return cells_.size(); }
  /// In the order in which they were added; after solve().
  [[nodiscard]] const Fan& fan(std::size_t cell) const noexcept { return cells_[cell].fan; }
  [[nodiscard]] const IVec3& first(std::size_t cell) const noexcept { return cells_[cell].first; }
  /// How many triangles it replaces.
  [[nodiscard]] std::size_t replaced(std::size_t cell) const noexcept { return cells_[cell].triangles; }
  [[nodiscard]] std::span<const std::uint32_t> loop(std::size_t cell) const noexcept {
    return std::span(loops_).subspan(cells_[cell].loop, cells_[cell].corners);
  }

 private:
  struct Cell {
    IVec3 first;
    int edge;
    std::size_t loop, corners, triangle, triangles;
    double tolerance;
    Fan fan;
  };
  /// Through a cell, in units of the lattice: from `from` to `from` + `along`.
  struct Line {
    Vec3 from, along;
    std::size_t cell;
  };
  [[nodiscard]] bool find_line(const Lattice& lattice, Cell& cell, std::span<const Vec3f> positions,
                               std::span<const Vec3f> normals, Line& line) const;
  [[nodiscard]] bool is_embedded(const Lattice& lattice, const Cell& cell, std::span<const Vec3f> positions) const;
  void judge(const Lattice& lattice, const Field& field, std::span<const Vec3f> positions,
             std::span<const Vec3f> normals);
  void gather(const Vec3& p);
  void evaluate(const Field& field);

  std::vector<Cell> cells_;
  std::vector<std::uint32_t> loops_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Line> lines_;
  RootSolver solver_;
  std::vector<double> x_, y_, z_, f_;
  std::size_t evaluations_ = 0;
};

/// The vertex of a fan in a finest cell.
struct Apex {
  std::uint32_t vertex;
  IVec3 cell;
  Vec3 up;  ///< As CellFans::Fan.
};

/// Turns the side that two fans share, and that a crease crosses, so that it joins their vertices along the crease.
///
/// Where the new side passes through the face between the cells, the two new triangles are those of fans whose polygons
/// take a detour over that point. They are taken when both fans are graphs all the same, the point lies within the face
/// and the face carries nothing else: then what was said of fans holds for them. `apexes` in the order of their
/// vertices; a fan's triangles have it as their last corner.
void join_creases(const Lattice& lattice, std::span<const Apex> apexes, std::span<const Vec3f> positions,
                  std::span<const Vec3f> normals, std::span<std::array<std::uint32_t, 3>> triangles);

}  // namespace outcrop::meshing

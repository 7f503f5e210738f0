/// Where bricks are split: from the field and the lattice alone, so that all pieces of a region agree.
#pragma once

#include <cstddef>
#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "brick_tree.h"
#include "lattice.h"

namespace outcrop::meshing {

/// How far the surface in a brick lies from what the brick's nodes make of it.
class BrickError {
 public:
  /// @return about how many metres marching cubes in this brick would be off: sampled on its triangles, more densely
  /// the coarser the brick, and where surface hides between nodes of one sign, since values along the lattice's lines
  /// head for 0 from both sides. Stops when that is more than `enough`. `field` is narrowed to the brick; `values` are
  /// the brick's.
  double measure(double enough, const Lattice& lattice, const Field& field, const Brick& brick,
                 const BrickValues& values);
  /// The same for the triangles of each octant of the brick measured last, up to what makes it certain that the octant
  /// is split. Not of a brick at level 1, where it stops as soon as it can.
  [[nodiscard]] const std::array<double, 8>& octants() const noexcept { return octants_; }
  /// Field values computed since construction.
  [[nodiscard]] std::size_t evaluations() const noexcept { return evaluations_; }

 private:
  /// Forgets the points that were gathered before.
  void start();
  struct Vertex {
    Vec3 index;
    double value = 0.0;
    bool known = false;  ///< Its value.
  };
  /// A cell that holds rock and air, and its part of triangles_.
  struct MixedCell {
    int node, first, last;
  };
  [[nodiscard]] double hidden(double enough, const Lattice& lattice, const Field& field, const Brick& brick,
                              const BrickValues& values);
  /// Surface in cells of one sign that are large enough to bury a block, as far as clear_value() allows any.
  [[nodiscard]] double buried(const Lattice& lattice, const Field& field, const Brick& brick,
                              const BrickValues& values);
  void reconstruct(const Brick& brick, const BrickValues& values);
  /// |∇f| of a cell, from its corners.
  [[nodiscard]] static double slope(const Vec3& per_metre, const BrickValues& values, int node);
  /// What the triangles of these cells are off by; octants_ take it in.
  [[nodiscard]] double deviation(const Lattice& lattice, const Field& field, const Brick& brick,
                                 const BrickValues& values, std::span<const MixedCell> cells, int subdivisions);

  std::size_t evaluations_ = 0;
  std::vector<Vertex> vertices_;
  std::vector<std::array<int, 3>> triangles_;  ///< Of vertices_.
  std::vector<MixedCell> cells_;
  std::vector<int> asked_;  ///< Vertices.
  std::vector<double> x_, y_, z_, f_, slopes_;
  std::array<double, 8> octants_{};
  std::array<int, 3 * kNodes> vertex_of_edge_{};
};

/// True where a brick is to be split, whatever the field; for tests.
using ForcedSplits = std::function<bool(const BrickPlace&)>;

/// What refinement computed in a cell, so that nobody does it again.
struct KnownCell {
  FieldPtr field;              ///< Narrowed to it.
  std::vector<double> values;  ///< BrickValues::all(); empty: not known.
};

struct Refinement {
  std::vector<BrickPlace> leaves;  ///< In Morton order.
  std::vector<std::pair<BrickPlace, KnownCell>> known;
  std::size_t evaluations = 0;
};

/// The bricks of one octree cell at `level`: from the lattice's coarsest level downwards each is split while its error
/// exceeds the tolerance, unless `forced` decides; not yet balanced. An octant that is off by so much that its error
/// cannot but exceed the tolerance is split without a look. Cost: 9³ values, and about two more a triangle, for
/// each brick above level 0.
[[nodiscard]] Refinement refine(const Lattice& lattice, const Cell& cell, int level, double tolerance,
                                const ForcedSplits& forced);

}  // namespace outcrop::meshing

/// Roots of a field on edges of the lattice.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lattice.h"

namespace outcrop::meshing {

/// A vertex keeps this share of the edge's length away from its ends, so that no triangle degenerates when the surface
/// passes through a node, not even after rounding to float.
inline constexpr double kEndShare = 0.02;

/// Cuts edges, and other lines, between rock and air, in a few batches.
class RootSolver {
 public:
  void clear() noexcept { count_ = 0; }
  /// An edge from a node of the lattice, or a middle between nodes, to `from` + `along`; the field's values at its ends
  /// differ in sign. The edges' starts come first by z, y, x, so that all who cut an edge cut it alike.
  void add(const Vec3& from, const Vec3& along, double f_a, double f_b) {
    if (count_ == t_.size()) grow();
    for (int axis = 0; axis < 3; ++axis) {
      from_[axis][count_] = from[axis];
      along_[axis][count_] = along[axis];
    }
    f_a_[count_] = f_a;
    f_b_[count_++] = f_b;
  }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// Finds a root on each edge: first where the values at its ends would have it if f were straight; edges on which it
  /// is not go on with safeguarded quadratic interpolation (Muller 1956). The same roots with and without gradients.
  /// @return field values computed, mostly one an edge.
  std::size_t solve(const Lattice& lattice, const Field& field, bool gradients);
  /// Where the roots are, world; kEndShare to 1 − kEndShare of their edges.
  [[nodiscard]] Points places() const noexcept {
    return {std::span(world_[0]).first(count_), std::span(world_[1]).first(count_), std::span(world_[2]).first(count_)};
  }
  /// The same in units of the lattice.
  [[nodiscard]] Vec3 index(std::size_t i) const noexcept {
    return {from_[0][i] + t_[i] * along_[0][i], from_[1][i] + t_[i] * along_[1][i], from_[2][i] + t_[i] * along_[2][i]};
  }
  /// The same as meshes store it.
  [[nodiscard]] Vec3f local(std::size_t i) const noexcept {
    return Vec3f(Vec3(offset_[0][i], offset_[1][i], offset_[2][i]) + shift_);
  }
  /// ∇f there, when asked for.
  [[nodiscard]] std::span<const Vec3> gradients() const noexcept { return gradients_; }

 private:
  using Coordinates = std::array<std::vector<double>, 3>;
  /// An edge whose root lies between a and b; d is the last place that b or a was moved from.
  struct Bracket {
    std::size_t edge;
    double t, tolerance;
    double t_a, f_a, t_b, f_b, t_d, f_d;

    bool narrow(double f);
    void propose(int step);
  };
  void grow();
  void place(const Lattice& lattice, std::size_t edge);
  std::size_t refine(const Lattice& lattice, const Field& field, bool gradients);

  std::size_t count_ = 0;
  Coordinates from_, along_;  ///< In units of the lattice.
  std::vector<double> f_a_, f_b_, t_, values_;
  Coordinates offset_, world_;  ///< Of the roots: from the lattice's corner, and from the world's.
  Vec3 shift_{0.0};             ///< From the mesh's origin to the lattice's corner.
  std::vector<Vec3> gradients_;
  std::vector<Bracket> open_;  ///< Edges whose root is not found yet, and what `refine` asks for.
  Coordinates asked_;
  std::vector<Vec3> asked_gradients_;
};

}  // namespace outcrop::meshing

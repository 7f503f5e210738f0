/// Roots of a field on edges of the lattice.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lattice.h"

namespace outcrop::meshing {

/// A vertex keeps this share of the edge's length away from its ends, so that no triangle degenerates when the surface
/// passes through a node, not even after rounding to float.
inline constexpr double kEndShare = 0.02;

/// An edge between rock and air, and the place where it is cut.
struct Crossing {
  IVec3 from{0}, along{0};  ///< Lattice index of its start, and to its end; the start comes first by z, y, x.
  double t = 0.5;           ///< Of the edge, kEndShare to 1 − kEndShare.

  // The bracket that the solver narrows.
  double f_a = 0.0, f_b = 0.0, t_a = 0.0, t_b = 1.0;
  double tolerance = 0.0;
  int kept = 0;  ///< Which end the last step kept: −1 a, 1 b.

  /// In units of the lattice.
  [[nodiscard]] Vec3 index() const noexcept { return Vec3(from) + t * Vec3(along); }
};

/// Solves for all crossings together, in a few batches.
class RootSolver {
 public:
  /// Sets `t` of each crossing from its values at the edge's ends, `f_a` and `f_b`: safeguarded regula falsi (Illinois,
  /// Dowell and Jarratt 1971). @return field values computed.
  std::size_t solve(const Lattice& lattice, const Field& field, std::span<Crossing> crossings, bool gradients);
  /// Where the crossings are, world.
  [[nodiscard]] Points places() const noexcept { return {x_, y_, z_}; }
  /// ∇f there, when asked for.
  [[nodiscard]] std::span<const Vec3> gradients() const noexcept { return gradients_; }

 private:
  void gather(const Lattice& lattice, std::span<const Crossing> crossings);

  std::vector<double> x_, y_, z_, values_;
  std::vector<Vec3> gradients_;
  std::vector<std::size_t> active_;
};

}  // namespace outcrop::meshing

#include "roots.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace outcrop::meshing {
namespace {

/// Residual at which a root is good, as a share of the difference of f along the edge: of a cell, where f is straight.
constexpr double kResidual = 2.5e-4;
/// Bracket at which a root is good where f has a kink or a jump, as a share of the edge.
constexpr double kBracket = 5e-4;
constexpr int kMaxSteps = 12;

void propose(Crossing& c) {
  const double lo = std::max(c.t_a, kEndShare), hi = std::min(c.t_b, 1.0 - kEndShare);
  const double t = c.t_a + (c.t_b - c.t_a) * (c.f_a / (c.f_a - c.f_b));
  // Written so that a t that is no number ends in the middle.
  c.t = t > lo ? (t < hi ? t : hi) : (t <= lo ? lo : 0.5 * (lo + hi));
}

/// Takes in the value at `t`; false when the root is found.
bool refine(Crossing& c, double f) {
  if (std::abs(f) <= c.tolerance) return false;
  if ((f < 0.0) == (c.f_a < 0.0)) {
    if (c.kept == 1) c.f_b *= 0.5;
    c.kept = 1;
    c.t_a = c.t;
    c.f_a = f;
  } else {
    if (c.kept == -1) c.f_a *= 0.5;
    c.kept = -1;
    c.t_b = c.t;
    c.f_b = f;
  }
  // A root in the share that is kept free is where `t` is already: at the share's end.
  if (c.t_b <= kEndShare || c.t_a >= 1.0 - kEndShare) return false;
  return c.t_b - c.t_a > kBracket;
}

}  // namespace

void RootSolver::gather(const Lattice& lattice, std::span<const Crossing> crossings) {
  const std::size_t n = active_.size();
  x_.resize(n);
  y_.resize(n);
  z_.resize(n);
  values_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p = lattice.place(crossings[active_[i]].index());
    x_[i] = p.x;
    y_[i] = p.y;
    z_[i] = p.z;
  }
}

std::size_t RootSolver::solve(const Lattice& lattice, const Field& field, std::span<Crossing> crossings,
                              bool gradients) {
  std::size_t evaluations = 0;
  const auto activate_all = [&] {
    active_.resize(crossings.size());
    std::iota(active_.begin(), active_.end(), std::size_t{0});
  };
  activate_all();
  for (Crossing& c : crossings) {
    c.tolerance = kResidual * std::abs(c.f_a - c.f_b);
    propose(c);
  }
  for (int step = 0; step < kMaxSteps && !active_.empty(); ++step) {
    gather(lattice, crossings);
    field.values({x_, y_, z_}, values_, {});
    evaluations += active_.size();
    std::size_t left = 0;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      Crossing& c = crossings[active_[i]];
      if (!refine(c, values_[i])) continue;
      propose(c);
      active_[left++] = active_[i];
    }
    active_.resize(left);
  }
  activate_all();
  gather(lattice, crossings);
  gradients_.clear();
  if (gradients) {
    gradients_.resize(crossings.size());
    field.values({x_, y_, z_}, values_, gradients_);
    evaluations += crossings.size();
  }
  return evaluations;
}

}  // namespace outcrop::meshing

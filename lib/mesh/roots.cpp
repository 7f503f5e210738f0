#include "roots.h"

#include <algorithm>
#include <cmath>

#include "outcrop/core/simd.h"

namespace outcrop::meshing {
namespace {

/// Residual at which a root is good, as a share of the difference of f along the edge: of a cell, where f is straight.
constexpr double kResidual = 2.5e-4;
/// Bracket at which a root is good where f has a kink or a jump, as a share of the edge.
constexpr double kBracket = 5e-4;
constexpr int kMaxSteps = 12;

/// Where a straight f would be 0.
OUTCROP_SIMD_CLONES
void cut_straight(std::size_t n, const double* __restrict f_a, const double* __restrict f_b, double* __restrict t) {
  for (std::size_t i = 0; i < n; ++i) {
    const double straight = f_a[i] / (f_a[i] - f_b[i]);
    // Written so that a t that is no number ends at an end.
    const double above = straight > kEndShare ? straight : kEndShare;
    t[i] = above < 1.0 - kEndShare ? above : 1.0 - kEndShare;
  }
}

/// One coordinate of the places at `t`.
OUTCROP_SIMD_CLONES
void place_all(std::size_t n, double lo, double step, const double* __restrict from, const double* __restrict along,
               const double* __restrict t, double* __restrict offset, double* __restrict world) {
  for (std::size_t i = 0; i < n; ++i) {
    offset[i] = (from[i] + t[i] * along[i]) * step;
    world[i] = lo + offset[i];
  }
}

}  // namespace

/// Takes in the value at `t`; false when the root is found.
bool RootSolver::Bracket::narrow(double f) {
  if (std::abs(f) <= tolerance) return false;
  if ((f < 0.0) == (f_a < 0.0)) {
    t_d = t_a, f_d = f_a;
    t_a = t, f_a = f;
  } else {
    t_d = t_b, f_d = f_b;
    t_b = t, f_b = f;
  }
  // A root in the share that is kept free is where `t` is already: at the share's end.
  if (t_b <= kEndShare || t_a >= 1.0 - kEndShare) return false;
  return t_b - t_a > kBracket;
}

void RootSolver::Bracket::propose(int step) {
  const double lo = std::max(t_a, kEndShare), hi = std::min(t_b, 1.0 - kEndShare);
  const double slope = (f_b - f_a) / (t_b - t_a);
  t = t_a - f_a / slope;
  if (step % 2 == 1) {
    // The parabola through a, b and d: f_a + linear · (t − t_a) + bend · (t − t_a)².
    const double bend = (slope - (f_d - f_a) / (t_d - t_a)) / (t_b - t_d);
    const double linear = slope - bend * (t_b - t_a);
    const double root = std::sqrt(std::max(linear * linear - 4.0 * bend * f_a, 0.0));
    const double curved = t_a - 2.0 * f_a / (linear + std::copysign(root, linear));
    if (curved > t_a && curved < t_b) t = curved;
  } else if (step % 4 == 0) {
    t = 0.5 * (t_a + t_b);
  }
  // Written so that a t that is no number ends in the middle.
  t = t > lo ? (t < hi ? t : hi) : (t <= lo ? lo : 0.5 * (lo + hi));
}

void RootSolver::grow() {
  const std::size_t size = std::max<std::size_t>(256, 2 * t_.size());
  for (Coordinates* coordinates : {&from_, &along_, &offset_, &world_})
    for (std::vector<double>& axis : *coordinates) axis.resize(size);
  for (std::vector<double>* values : {&f_a_, &f_b_, &t_, &values_}) values->resize(size);
}

void RootSolver::place(const Lattice& lattice, std::size_t edge) {
  for (int axis = 0; axis < 3; ++axis) {
    offset_[axis][edge] = (from_[axis][edge] + t_[edge] * along_[axis][edge]) * lattice.step[axis];
    world_[axis][edge] = lattice.lo[axis] + offset_[axis][edge];
  }
}

std::size_t RootSolver::solve(const Lattice& lattice, const Field& field, bool gradients) {
  gradients_.resize(gradients ? count_ : 0);
  shift_ = lattice.lo - lattice.origin;
  if (count_ == 0) return 0;
  cut_straight(count_, f_a_.data(), f_b_.data(), t_.data());
  for (int axis = 0; axis < 3; ++axis)
    place_all(count_, lattice.lo[axis], lattice.step[axis], from_[axis].data(), along_[axis].data(), t_.data(),
              offset_[axis].data(), world_[axis].data());
  field.values(places(), std::span(values_).first(count_), gradients_);
  open_.clear();
  for (std::size_t i = 0; i < count_; ++i) {
    const double tolerance = kResidual * std::abs(f_a_[i] - f_b_[i]);
    if (std::abs(values_[i]) <= tolerance) continue;
    Bracket bracket{i, t_[i], tolerance, 0.0, f_a_[i], 1.0, f_b_[i], 0.0, 0.0};
    if (bracket.narrow(values_[i])) open_.push_back(bracket);
  }
  return count_ + refine(lattice, field, gradients);
}

std::size_t RootSolver::refine(const Lattice& lattice, const Field& field, bool gradients) {
  std::size_t evaluations = 0;
  for (int step = 1; step < kMaxSteps && !open_.empty(); ++step) {
    const std::size_t n = open_.size();
    for (std::vector<double>& axis : asked_) axis.resize(n);
    asked_gradients_.resize(gradients ? n : 0);
    for (std::size_t i = 0; i < n; ++i) {
      open_[i].propose(step);
      const std::size_t edge = open_[i].edge;
      t_[edge] = open_[i].t;
      place(lattice, edge);
      for (int axis = 0; axis < 3; ++axis) asked_[axis][i] = world_[axis][edge];
    }
    field.values({asked_[0], asked_[1], asked_[2]}, std::span(values_).first(n), asked_gradients_);
    evaluations += n;
    std::size_t left = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (gradients) gradients_[open_[i].edge] = asked_gradients_[i];
      if (open_[i].narrow(values_[i])) open_[left++] = open_[i];
    }
    open_.resize(left);
  }
  return evaluations;
}

}  // namespace outcrop::meshing

/// Closed intervals and axis-aligned boxes.
#pragma once

#include <algorithm>
#include <limits>

#include <glm/common.hpp>

#include "outcrop/core/vec.h"

namespace outcrop {

/// A closed interval [lo, hi]; empty when lo > hi.
struct Interval {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();

  [[nodiscard]] constexpr bool contains(double v) const noexcept { return lo <= v && v <= hi; }
  [[nodiscard]] constexpr bool empty() const noexcept { return lo > hi; }
  [[nodiscard]] constexpr double width() const noexcept { return hi - lo; }
  constexpr void include(double v) noexcept {
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
};

[[nodiscard]] constexpr Interval hull(const Interval& a, const Interval& b) noexcept {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}
[[nodiscard]] constexpr Interval intersection(const Interval& a, const Interval& b) noexcept {
  return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}
/// The interval of min(a, b) for a in A, b in B.
[[nodiscard]] constexpr Interval min(const Interval& a, const Interval& b) noexcept {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}
/// The interval of max(a, b) for a in A, b in B.
[[nodiscard]] constexpr Interval max(const Interval& a, const Interval& b) noexcept {
  return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
}

/// An axis-aligned box [lo, hi] in metres; empty when lo exceeds hi on any axis.
struct Box {
  Vec3 lo{std::numeric_limits<double>::infinity()};
  Vec3 hi{-std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool empty() const noexcept { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  [[nodiscard]] Vec3 centre() const noexcept { return 0.5 * (lo + hi); }
  [[nodiscard]] Vec3 size() const noexcept { return hi - lo; }
  /// Distance from the centre to a corner.
  [[nodiscard]] double half_diagonal() const noexcept { return 0.5 * glm::length(hi - lo); }
  [[nodiscard]] bool contains(const Vec3& p) const noexcept {
    return lo.x <= p.x && p.x <= hi.x && lo.y <= p.y && p.y <= hi.y && lo.z <= p.z && p.z <= hi.z;
  }
  [[nodiscard]] bool overlaps(const Box& b) const noexcept {
    return lo.x <= b.hi.x && b.lo.x <= hi.x && lo.y <= b.hi.y && b.lo.y <= hi.y && lo.z <= b.hi.z && b.lo.z <= hi.z;
  }
  /// The box grown by `margin` metres on all six sides.
  [[nodiscard]] Box grown(double margin) const noexcept { return {lo - Vec3(margin), hi + Vec3(margin)}; }
  [[nodiscard]] Box moved(const Vec3& by) const noexcept { return {lo + by, hi + by}; }
  void include(const Vec3& p) noexcept {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
};

[[nodiscard]] inline Box intersection(const Box& a, const Box& b) noexcept {
  return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
}
[[nodiscard]] inline Box hull(const Box& a, const Box& b) noexcept {
  return {glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)};
}

}  // namespace outcrop

#include "outcrop/implicit/rounded_polytope.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lanes.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

// The Lipschitz constant of a warped polytope.
//
// Let c be the fold, g = ∇c, t = |g| ≤ 1, u = g / t, D(p) = A · F(t) · (1 − s) with s = Σ|g_j| d_j / Σ|g_j|, and
// b(p) = c(q), q = p + D u. With G = ∇c(q) and H the Hessian of c at p:
//   ∇b = G + (u·G) ∇D + D H (I − u uᵀ) G / t.
//   |G| ≤ 1, since every fold weighs unit normals with weights that sum to 1.
//   ∇D = A [F'(t) (1 − s) H u − F(t) ∇s], and ∇s is a convex sum of the relief's gradients, at most its slope S, plus
//   H v / |g|₁ with v_j = ± (d_j − s): all d_j and s are in [0, 1] and s is one of their means, so |v| ≤ √2; |g|₁ ≥ t.
//   c is convex, so u·G grows along u: u·G ≥ u·g = t, and the part of G across u is at most √(1 − t²).
// With |H| ≤ η this gives L ≤ 1 + A S + A η K(t), K(t) = F'(t) + √2 F(t) / t + F(t) √(1 − t²) / t.
//
// η grows with the planes that can be active together: a fold step with weight k ∈ [0, 1] bends by k/R in the direction
// g − n and keeps at most 1 − k²/2 of the bend before it, so η' = max over k of (1 − k²/2) η + δ² k / R, where δ is the
// largest angle's chord between the new normal and those before it.
constexpr double kLargestGain = 5.85;  // max K over t ∈ (0, 1] is 5.844, at t = 0.511.

/// K from a lower bound of |g|: it falls where the fade is complete.
[[nodiscard]] double warp_gain(double least_length) {
  if (least_length < lanes::kFadeEnd) return kLargestGain;
  const double t = std::min(least_length, 1.0);
  return (std::sqrt(2.0) + std::sqrt(1.0 - t * t)) / t;
}

/// The largest bend after a fold step: see above.
[[nodiscard]] double bend_after(double bend, double chord_squared, double largest_weight, double rounding) {
  const double best = bend > 0.0 ? chord_squared / (rounding * bend) : largest_weight;
  const double k = std::min(best, largest_weight);
  return (1.0 - 0.5 * k * k) * bend + chord_squared * k / rounding;
}

/// 1 / R for smax; 0 for the sharp maximum.
[[nodiscard]] double inverse_of(double rounding) { return rounding > 0.0 ? 1.0 / rounding : 0.0; }

[[nodiscard]] double smax(double a, double b, double rounding, double inverse) {
  const double k = std::max(1.0 - std::abs(a - b) * inverse, 0.0);
  return std::max(a, b) + rounding / 6.0 * k * k * k;
}

/// The planes' distances over a box.
class PlanesOverBox {
 public:
  /// Over the box and what lies within `around` of it.
  PlanesOverBox(const PackedPlanes& planes, const TurnedBox& box, double around)
      : planes_(planes), box_(box), around_(around) {}

  [[nodiscard]] double at_centre(std::size_t k) const {
    return glm::dot(planes_.normal(k), box_.centre) + planes_.d()[k];
  }
  [[nodiscard]] Interval range(std::size_t k) const {
    const Vec3 along = glm::abs(planes_.normal(k) * box_.half);
    const double centre = at_centre(k), reach = along.x + along.y + along.z + around_;
    return {centre - reach, centre + reach};
  }

 private:
  const PackedPlanes& planes_;
  const TurnedBox& box_;
  double around_;
};

/// A lower bound of |g| for every convex sum g of the normals: how far they reach along their mean direction.
[[nodiscard]] double least_gradient(const PackedPlanes& planes) {
  Vec3 mean{0.0};
  for (std::size_t k = 0; k < planes.size(); ++k) mean += planes.normal(k);
  const double length = glm::length(mean);
  if (length < 1e-6) return 0.0;
  double least = 1.0;
  for (std::size_t k = 0; k < planes.size(); ++k) least = std::min(least, glm::dot(planes.normal(k), mean) / length);
  return std::max(least, 0.0);
}

/// `largest_weights[i]` bounds the fold weight k of kept plane i, or is empty for "1 each".
[[nodiscard]] double warped_lipschitz(const PackedPlanes& planes, std::span<const double> largest_weights,
                                      double rounding, const Warp& warp) {
  double bend = 0.0;
  for (std::size_t k = 1; k < planes.size(); ++k) {
    double chord_squared = 0.0;
    for (std::size_t i = 0; i < k; ++i) {
      const Vec3 chord = planes.normal(i) - planes.normal(k);
      chord_squared = std::max(chord_squared, glm::dot(chord, chord));
    }
    bend = bend_after(bend, chord_squared, largest_weights.empty() ? 1.0 : largest_weights[k], rounding);
  }
  return 1.0 + warp.amplitude * (warp.relief->slope() + bend * warp_gain(least_gradient(planes)));
}

[[nodiscard]] double largest_coordinate_sum(const Box& box) {
  const Vec3 reach = glm::max(glm::abs(box.lo), glm::abs(box.hi));
  return reach.x + reach.y + reach.z;
}

[[nodiscard]] lanes::PlaneView view(const PackedPlanes& planes, float rounding) {
  return {planes.nx(), planes.ny(), planes.nz(), planes.d(), static_cast<int>(planes.size()), rounding};
}

/// Where carving takes points.
struct Moved {
  lanes::Lane x, y, z;

  Moved(int n, const float* from_x, const float* from_y, const float* from_z, const lanes::Fold& fold,
        const lanes::Carving& carving) {
    for (int i = 0; i < n; ++i) {
      x[i] = from_x[i] + carving.step[i] * fold.gradient[0][i];
      y[i] = from_y[i] + carving.step[i] * fold.gradient[1][i];
      z[i] = from_z[i] + carving.step[i] * fold.gradient[2][i];
    }
  }
};

}  // namespace

PackedPlanes::PackedPlanes(std::span<const Plane> planes) : rows_(4 * planes.size()) {
  // Adding 0 turns −0 into 0: no sum in the fold is then −0, and dropping a plane cannot change the sign of a zero.
  const std::size_t n = planes.size();
  for (std::size_t k = 0; k < n; ++k) {
    for (int axis = 0; axis < 3; ++axis) rows_[axis * n + k] = static_cast<float>(planes[k].normal[axis]) + 0.0f;
    rows_[3 * n + k] = static_cast<float>(planes[k].offset) + 0.0f;
  }
}

PackedPlanes PackedPlanes::only(std::span<const std::uint32_t> indices) const {
  PackedPlanes result;
  result.rows_.resize(4 * indices.size());
  for (int row = 0; row < 4; ++row)
    for (std::size_t i = 0; i < indices.size(); ++i)
      result.rows_[row * indices.size() + i] = rows_[row * size() + indices[i]];
  return result;
}

PolytopeKernel::PolytopeKernel(std::span<const Plane> planes, double rounding, Warp warp, Vec3 relief_origin)
    : rounding_(static_cast<float>(rounding)), warp_(std::move(warp)), relief_origin_(relief_origin) {
  constexpr double kUnitTolerance = 1e-5;
  require(!planes.empty(), "planes", "at least 1", 0.0);
  require(rounding == 0.0 || (rounding >= 1e-6 && std::isfinite(rounding)), "rounding", "0, or at least 1e-6 m",
          rounding);
  require(warp_.amplitude >= 0.0 && std::isfinite(warp_.amplitude), "amplitude", ">= 0 and finite", warp_.amplitude);
  require(!warp_.active() || rounding > 0.0, "rounding", "> 0 where a relief is carved", rounding);
  for (const Plane& plane : planes) {
    require(std::abs(glm::length(plane.normal) - 1.0) < kUnitTolerance, "normal", "a unit vector",
            glm::length(plane.normal));
    require(std::isfinite(plane.offset), "offset", "finite", plane.offset);
    farthest_ = std::max(farthest_, std::abs(plane.offset));
  }
  planes_ = PackedPlanes(planes);
  if (warp_.active()) lipschitz_ = warped_lipschitz(planes_, {}, rounding_, warp_);
}

void PolytopeKernel::values(std::size_t n, const float* x, const float* y, const float* z, float* out,
                            Vec3f* gradients) const noexcept {
  for (std::size_t first = 0; first < n; first += lanes::kLanes) {
    const int count = static_cast<int>(std::min<std::size_t>(lanes::kLanes, n - first));
    Vec3f* const block_gradients = gradients ? gradients + first : nullptr;
    if (warp_.active())
      warped(count, x + first, y + first, z + first, out + first, block_gradients);
    else
      unwarped(count, x + first, y + first, z + first, out + first, block_gradients);
  }
}

double PolytopeKernel::value_below(double ceiling, float x, float y, float z) const noexcept {
  constexpr double kAbove = std::numeric_limits<double>::infinity();
  const lanes::PlaneView planes = view(planes_, rounding_);
  lanes::Fold fold;
  // The relief only carves, but for rounding, and the caller may have rounded the ceiling.
  const double top = ceiling + 2.0 * rounding_slack(std::abs(x) + std::abs(y) + std::abs(z));
  if (!warp_.active()) return lanes::fold_value_below(planes, top, x, y, z, fold) ? fold.value[0] : kAbove;
  if (!lanes::fold_gradient_below(planes, top, x, y, z, fold)) return kAbove;
  lanes::Carving carving;
  lanes::carve(warp_, relief_origin_, 1, &x, &y, &z, fold.gradient, carving);
  const Moved q(1, &x, &y, &z, fold, carving);
  lanes::fold_values(planes, 1, q.x, q.y, q.z, fold);
  return fold.value[0];
}

void PolytopeKernel::folded(std::size_t n, const float* x, const float* y, const float* z, float* out) const noexcept {
  lanes::Fold fold;
  for (std::size_t first = 0; first < n; first += lanes::kLanes) {
    const int count = static_cast<int>(std::min<std::size_t>(lanes::kLanes, n - first));
    lanes::fold_values(view(planes_, rounding_), count, x + first, y + first, z + first, fold);
    for (int i = 0; i < count; ++i) out[first + i] = fold.value[i];
  }
}

void PolytopeKernel::unwarped(int n, const float* x, const float* y, const float* z, float* out,
                              Vec3f* gradients) const noexcept {
  lanes::Fold fold;
  if (gradients)
    lanes::fold_gradients(view(planes_, rounding_), n, x, y, z, fold);
  else
    lanes::fold_values(view(planes_, rounding_), n, x, y, z, fold);
  std::copy_n(fold.value, n, out);
  if (!gradients) return;
  for (int i = 0; i < n; ++i) gradients[i] = {fold.gradient[0][i], fold.gradient[1][i], fold.gradient[2][i]};
}

void PolytopeKernel::warped(int n, const float* x, const float* y, const float* z, float* out,
                            Vec3f* gradients) const noexcept {
  const lanes::PlaneView planes = view(planes_, rounding_);
  lanes::Fold here, there;
  lanes::Carving carving;
  if (!gradients) {
    lanes::fold_gradients(planes, n, x, y, z, here);
    lanes::carve(warp_, relief_origin_, n, x, y, z, here.gradient, carving);
    const Moved q(n, x, y, z, here, carving);
    lanes::fold_values(planes, n, q.x, q.y, q.z, there);
    std::copy_n(there.value, n, out);
    return;
  }
  lanes::fold_hessians(planes, n, x, y, z, here);
  lanes::carve_with_slopes(warp_, relief_origin_, n, x, y, z, here.gradient, carving);
  const Moved q(n, x, y, z, here, carving);
  lanes::fold_gradients(planes, n, q.x, q.y, q.z, there);
  std::copy_n(there.value, n, out);
  lanes::Lane carved[3];
  lanes::carved_gradients(n, here, there, carving, carved);
  for (int i = 0; i < n; ++i) gradients[i] = {carved[0][i], carved[1][i], carved[2][i]};
}

Interval PolytopeKernel::bound(const TurnedBox& local) const noexcept {
  // smax grows with both arguments, so folding the ends bounds the fold; the fold is 1-Lipschitz, so its value at the
  // centre bounds it too. The warp only carves: c(p) ≤ b(p) ≤ c(p) + amplitude, since c is convex and 1-Lipschitz.
  const PlanesOverBox h(planes_, local, 0.0);
  const double inverse = inverse_of(rounding_);
  Interval fold = h.range(0);
  double at_centre = h.at_centre(0);
  for (std::size_t k = 1; k < planes_.size(); ++k) {
    const Interval range = h.range(k);
    fold = {smax(fold.lo, range.lo, rounding_, inverse), smax(fold.hi, range.hi, rounding_, inverse)};
    at_centre = smax(at_centre, h.at_centre(k), rounding_, inverse);
  }
  const double reach = local.radius;
  const double slack = rounding_slack(local.coordinate_sum());
  return {std::max(fold.lo, at_centre - reach) - slack, std::min(fold.hi, at_centre + reach) + slack + depth()};
}

PolytopeKernel PolytopeKernel::narrow(const TurnedBox& local) const {
  // A warped point lies up to the relief's depth outside of the box: planes are judged there too.
  const double around = depth() + 1e-6;
  const double reach = local.radius + around;
  const double apart =
      rounding_ + 1e-5 + 3.0 * rounding_slack(local.coordinate_sum());  // Beyond this the fold weight is 0 to the bit.

  const PlanesOverBox h(planes_, local, around);
  const double inverse = inverse_of(rounding_);
  std::vector<std::uint32_t> kept{0};
  std::vector<double> largest_weights{0.0};
  kept.reserve(planes_.size());
  largest_weights.reserve(planes_.size());
  Interval fold = h.range(0);
  double at_centre = h.at_centre(0);
  for (std::uint32_t k = 1; k < planes_.size(); ++k) {
    const Interval range = h.range(k);
    if (range.hi <= fold.lo - apart) continue;
    if (range.lo >= fold.hi + apart) {
      kept = {k};
      largest_weights = {0.0};
      fold = range;
      at_centre = h.at_centre(k);
      continue;
    }
    const double gap = std::max({range.lo - fold.hi, fold.lo - range.hi, 0.0});
    kept.push_back(k);
    largest_weights.push_back(rounding_ > 0.0f ? std::clamp(1.0 - (gap - 1e-5) / rounding_, 0.0, 1.0) : 1.0);
    at_centre = smax(at_centre, h.at_centre(k), rounding_, inverse);
    fold = intersection(
        Interval{smax(fold.lo, range.lo, rounding_, inverse), smax(fold.hi, range.hi, rounding_, inverse)},
        Interval{at_centre - reach, at_centre + reach});
  }
  PolytopeKernel result = *this;
  if (kept.size() < planes_.size()) result.planes_ = planes_.only(kept);
  if (warp_.active())
    result.lipschitz_ = std::min(lipschitz_, warped_lipschitz(result.planes_, largest_weights, rounding_, warp_));
  return result;
}

std::optional<Box> PolytopeKernel::support() const noexcept {
  // The corners of the sharp polytope, which contains the rounded one: all triples of planes, within a far box that
  // tells whether it is bounded.
  constexpr double kFar = 1e7;
  std::vector<Plane> sides;
  for (std::size_t k = 0; k < planes_.size(); ++k) sides.push_back({planes_.normal(k), planes_.d()[k]});
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Plane side{Vec3(0.0), -kFar};
      side.normal[axis] = sign;
      sides.push_back(side);
    }
  Box box;
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 edge = glm::cross(sides[i].normal, sides[j].normal);
      if (glm::length(edge) < 1e-9) continue;
      for (std::size_t k = 0; k < j; ++k) {
        const double volume = glm::dot(edge, sides[k].normal);
        if (std::abs(volume) < 1e-9) continue;
        const Vec3 corner = -(sides[k].offset * edge + sides[i].offset * glm::cross(sides[j].normal, sides[k].normal) +
                              sides[j].offset * glm::cross(sides[k].normal, sides[i].normal)) /
                            volume;
        const double tolerance = 1e-6 * (1.0 + glm::length(corner));
        if (std::all_of(sides.begin(), sides.end(), [&](const Plane& s) { return s.distance(corner) <= tolerance; }))
          box.include(corner);
      }
    }
  if (box.empty() || largest_coordinate_sum(box) > 0.1 * kFar) return std::nullopt;
  return box.grown(rounding_slack(largest_coordinate_sum(box)));
}

RoundedPolytope::RoundedPolytope(PolytopeKernel kernel, const Vec3& centre)
    : kernel_(std::move(kernel)), centre_(centre) {}

RoundedPolytope::RoundedPolytope(std::span<const Plane> planes, const Vec3& centre, double rounding, Warp warp)
    : centre_(centre) {
  std::vector<Plane> local(planes.begin(), planes.end());
  for (Plane& plane : local) plane.offset = plane.distance(centre);
  kernel_ = PolytopeKernel(local, rounding, std::move(warp), centre);
}

void RoundedPolytope::values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  constexpr std::size_t kBlock = 4 * lanes::kLanes;
  std::array<float, kBlock> x, y, z, value;
  std::array<Vec3f, kBlock> gradient;
  for (std::size_t first = 0; first < points.size(); first += kBlock) {
    const std::size_t n = std::min(kBlock, points.size() - first);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = static_cast<float>(points.x[first + i] - centre_.x);
      y[i] = static_cast<float>(points.y[first + i] - centre_.y);
      z[i] = static_cast<float>(points.z[first + i] - centre_.z);
    }
    kernel_.values(n, x.data(), y.data(), z.data(), value.data(), gradients.empty() ? nullptr : gradient.data());
    for (std::size_t i = 0; i < n; ++i) values[first + i] = value[i];
    if (!gradients.empty())
      for (std::size_t i = 0; i < n; ++i) gradients[first + i] = gradient[i];
  }
}

double RoundedPolytope::lipschitz() const noexcept { return kernel_.lipschitz(); }

Interval RoundedPolytope::bound(const Box& box) const noexcept { return kernel_.bound(TurnedBox(box.moved(-centre_))); }

FieldPtr RoundedPolytope::narrow(const Box& box) const {
  return std::make_shared<RoundedPolytope>(kernel_.narrow(TurnedBox(box.moved(-centre_))), centre_);
}

std::optional<Box> RoundedPolytope::support() const noexcept {
  const std::optional<Box> local = kernel_.support();
  return local ? std::optional(local->moved(centre_)) : std::nullopt;
}

}  // namespace outcrop

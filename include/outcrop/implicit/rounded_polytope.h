/// A smooth intersection of half-spaces, optionally carved by a relief: what a block of rock is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/implicit/field.h"
#include "outcrop/implicit/relief.h"

namespace outcrop {

/// The half-space n · p + offset ≤ 0; n is a unit vector that points out of the rock.
struct Plane {
  Vec3 normal{0, 0, 1};
  double offset = 0.0;

  [[nodiscard]] double distance(const Vec3& p) const noexcept { return glm::dot(normal, p) + offset; }
};

/// Carving by a relief: depth(p) = amplitude · (1 − d(p)), blended over the three axis planes.
struct Warp {
  ReliefPtr relief;        ///< Null: no carving.
  double amplitude = 0.0;  ///< Metres, ≥ 0.

  [[nodiscard]] bool active() const noexcept { return relief && amplitude > 0.0; }
};

/// Planes packed for the hot loop: floats relative to the polytope's own centre, so that results do not depend on the
/// box a field was narrowed to.
class PackedPlanes {
 public:
  PackedPlanes() = default;
  explicit PackedPlanes(std::span<const Plane> planes);

  [[nodiscard]] std::size_t size() const noexcept { return rows_.size() / 4; }
  [[nodiscard]] const float* nx() const noexcept { return rows_.data(); }
  [[nodiscard]] const float* ny() const noexcept { return rows_.data() + size(); }
  [[nodiscard]] const float* nz() const noexcept { return rows_.data() + 2 * size(); }
  [[nodiscard]] const float* d() const noexcept { return rows_.data() + 3 * size(); }
  [[nodiscard]] Vec3 normal(std::size_t k) const noexcept { return {nx()[k], ny()[k], nz()[k]}; }
  /// Those planes, in the order of `indices`.
  [[nodiscard]] PackedPlanes only(std::span<const std::uint32_t> indices) const;

 private:
  std::vector<float> rows_;  ///< All nx, then all ny, nz and d.
};

/// A box that may be turned against the axes: centre + half · [−1, 1]³.
struct TurnedBox {
  Vec3 centre{0.0};
  Mat3 half{1.0};       ///< Columns: from the centre to three sides.
  double radius = 0.0;  ///< Of the ball around it.

  TurnedBox(const Vec3& box_centre, const Mat3& half_edges)
      : centre(box_centre), half(half_edges), radius(glm::length(half[0] + half[1] + half[2])) {}
  explicit TurnedBox(const Box& box)
      : centre(box.centre()), half(0.0), radius(box.half_diagonal()) {
    for (int axis = 0; axis < 3; ++axis) half[axis][axis] = 0.5 * (box.hi[axis] - box.lo[axis]);
  }
  [[nodiscard]] TurnedBox moved(const Vec3& by) const {
    TurnedBox result = *this;
    result.centre += by;
    return result;
  }
  /// The largest |x| + |y| + |z| in the box is at most this.
  [[nodiscard]] double coordinate_sum() const {
    const Vec3 c = glm::abs(centre);
    return c.x + c.y + c.z + 1.7320509 * radius;
  }
};

/// Evaluates one rounded polytope: the fold, in the order of `planes`, of
/// smax(a, b) = max(a, b) + R/6 · max(1 − |a − b|/R, 0)³, then the gradient warp.
///
/// A value type shared by RoundedPolytope and the replication node.
/// Frame: `local` points are relative to the polytope's centre; `relief_origin` + local is where the relief is looked
/// up.
class PolytopeKernel {
 public:
  PolytopeKernel() = default;
  /// @param planes    At least 1, relative to the centre; unit normals.
  /// @param rounding  R ≥ 0 in metres; 0 is the sharp maximum. Needs R > 0 where the warp is active: the gradient of a
  ///                  sharp edge jumps, and the warped surface would tear.
  /// @throws ParameterError for a broken bound.
  PolytopeKernel(std::span<const Plane> planes, double rounding, Warp warp, Vec3 relief_origin);

  /// out[i] = b(local[i]); gradients when not null. Cost: O(n · planes), vectorised over points.
  void values(std::size_t n, const float* x, const float* y, const float* z, float* out,
              Vec3f* gradients) const noexcept;

  /// b at one point, a batch's bits, or infinity where b is sure to be above `ceiling` by more than rounding: there the
  /// relief is not asked, nor the rest of the planes.
  [[nodiscard]] double value_below(double ceiling, float x, float y, float z) const noexcept;

  /// out[i] = c(local[i]), the fold before the relief carves: c − ε ≤ b ≤ c + depth() + ε with ε = rounding_slack().
  void folded(std::size_t n, const float* x, const float* y, const float* z, float* out) const noexcept;
  /// The relief's largest depth: the warp's amplitude, 0 without one.
  [[nodiscard]] double depth() const noexcept { return warp_.active() ? warp_.amplitude : 0.0; }
  /// How far rounding may move a value where |x| + |y| + |z| is at most `coordinate_sum`: each plane's sum of four
  /// terms and each fold step may be off by an epsilon of the largest number in it.
  [[nodiscard]] double rounding_slack(double coordinate_sum) const noexcept {
    const double largest = coordinate_sum + std::max<double>(rounding_, farthest_);
    return 1e-6 + static_cast<double>(planes_.size() + 8) * std::numeric_limits<float>::epsilon() * largest;
  }

  /// Contains b over the box (relative to the centre): fold of plane intervals, tightened by the centre value, widened
  /// by the warp's amplitude upwards only (the relief only carves).
  [[nodiscard]] Interval bound(const TurnedBox& local) const noexcept;

  /// The kernel without the planes that cannot be active in the box: equal to the bit there. Its lipschitz() is the
  /// local one of what is left, often far smaller.
  [[nodiscard]] PolytopeKernel narrow(const TurnedBox& local) const;

  /// 1 without warp, else 1 + Lip(displacement): see the proof in rounded_polytope.cpp.
  [[nodiscard]] double lipschitz() const noexcept { return lipschitz_; }
  /// {1, depth()}: with c the fold, c ≤ b ≤ c + depth() and c is 1-Lipschitz, so that
  /// b(p) − b(q) ≤ c(p) + depth() − c(q) ≤ |p − q| + depth().
  [[nodiscard]] Modulus modulus() const noexcept { return {1.0, depth()}; }
  [[nodiscard]] std::size_t plane_count() const noexcept { return planes_.size(); }
  /// The box around the polytope, relative to the centre; nothing when it is unbounded. Cost: O(planes³).
  [[nodiscard]] std::optional<Box> support() const noexcept;

 private:
  void unwarped(int n, const float* x, const float* y, const float* z, float* out, Vec3f* gradients) const noexcept;
  void warped(int n, const float* x, const float* y, const float* z, float* out, Vec3f* gradients) const noexcept;

  PackedPlanes planes_;
  float rounding_ = 0.0f;
  Warp warp_;
  Vec3 relief_origin_{0.0};
  double lipschitz_ = 1.0;
  double farthest_ = 0.0;  ///< The largest |offset| of a plane.
};

/// A PolytopeKernel placed in the world as a Field of its own.
class RoundedPolytope final : public Field {
 public:
  /// @param planes  In world coordinates; bounded or not. @param rounding  Metres ≥ 0.
  RoundedPolytope(std::span<const Plane> planes, const Vec3& centre, double rounding, Warp warp = {});
  RoundedPolytope(PolytopeKernel kernel, const Vec3& centre);

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override;
  [[nodiscard]] double lipschitz() const noexcept override;
  [[nodiscard]] Modulus modulus() const noexcept override { return kernel_.modulus(); }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override;
  [[nodiscard]] FieldPtr narrow(const Box& box) const override;
  [[nodiscard]] std::optional<Box> support() const noexcept override;
  [[nodiscard]] const PolytopeKernel& kernel() const noexcept { return kernel_; }
  [[nodiscard]] const Vec3& centre() const noexcept { return centre_; }

 private:
  PolytopeKernel kernel_;
  Vec3 centre_;
};

}  // namespace outcrop

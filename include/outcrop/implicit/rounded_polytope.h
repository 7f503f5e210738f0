/// A smooth intersection of half-spaces, optionally carved by a relief: what a block of rock is.
#pragma once

#include <cstddef>
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
struct PackedPlanes {
  std::vector<float> nx, ny, nz, d;

  [[nodiscard]] std::size_t size() const noexcept { return nx.size(); }
  void push_back(const Plane& plane);
  /// Those planes, in the order of `indices`.
  [[nodiscard]] PackedPlanes only(std::span<const std::size_t> indices) const;
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

  /// Contains b over the box (relative to the centre): fold of plane intervals, tightened by the centre value, widened
  /// by the warp's amplitude upwards only (the relief only carves).
  [[nodiscard]] Interval bound(const Box& local) const noexcept;

  /// The kernel without the planes that cannot be active in the box: equal to the bit there. Its lipschitz() is the
  /// local one of what is left, often far smaller.
  [[nodiscard]] PolytopeKernel narrow(const Box& local) const;

  /// 1 without warp, else 1 + Lip(displacement): see the proof in rounded_polytope.cpp.
  [[nodiscard]] double lipschitz() const noexcept { return lipschitz_; }
  [[nodiscard]] std::size_t plane_count() const noexcept { return planes_.size(); }
  /// The box around the polytope, relative to the centre; nothing when it is unbounded. Cost: O(planes³).
  [[nodiscard]] std::optional<Box> support() const noexcept;

 private:
  void unwarped(int n, const float* x, const float* y, const float* z, float* out, Vec3f* gradients) const noexcept;
  void warped(int n, const float* x, const float* y, const float* z, float* out, Vec3f* gradients) const noexcept;
  [[nodiscard]] Interval plane_bound(std::size_t plane, const Box& local) const noexcept;
  [[nodiscard]] double rounding_slack(const Box& local) const noexcept;

  PackedPlanes planes_;
  float rounding_ = 0.0f;
  Warp warp_;
  Vec3 relief_origin_{0.0};
  double lipschitz_ = 1.0;
};

/// A PolytopeKernel placed in the world as a Field of its own.
class RoundedPolytope final : public Field {
 public:
  /// @param planes  In world coordinates; bounded or not. @param rounding  Metres ≥ 0.
  RoundedPolytope(std::span<const Plane> planes, const Vec3& centre, double rounding, Warp warp = {});
  RoundedPolytope(PolytopeKernel kernel, const Vec3& centre);

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override;
  [[nodiscard]] double lipschitz() const noexcept override;
  [[nodiscard]] Interval bound(const Box& box) const noexcept override;
  [[nodiscard]] FieldPtr narrow(const Box& box) const override;
  [[nodiscard]] std::optional<Box> support() const noexcept override;
  [[nodiscard]] const PolytopeKernel& kernel() const noexcept { return kernel_; }

 private:
  PolytopeKernel kernel_;
  Vec3 centre_;
};

}  // namespace outcrop

/// The hot loops of rounded polytopes and warps, over blocks of points: folds in lanes.cpp, reliefs in carving.cpp.
#pragma once

#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop::lanes {

/// Points a block: four vectors of 16, so that four folds, each a chain of dependent steps, are under way at once.
inline constexpr int kLanes = 64;
/// So many points are faster one by one, in plain code of the baseline: no call is chosen by the loader.
inline constexpr int kFewPoints = 8;

using Lane = float[kLanes];

/// What the fold of some planes answers at up to kLanes points.
struct alignas(64) Fold {
  Lane value;
  Lane gradient[3];
  Lane hessian[6];  ///< xx, yy, zz, yz, xz, xy.
};

/// Planes as the loops want them, borrowed from PackedPlanes.
struct PlaneView {
  const float* nx;
  const float* ny;
  const float* nz;
  const float* d;
  int count;
  float rounding;
};

/// The fold of smax over the planes, in their order, at n <= kLanes points. A point's bits do not depend on n, on how
/// much is asked for, or on the instruction set. `out` may be written beyond n.
void fold_values(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept;
void fold_gradients(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept;
void fold_hessians(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept;

/// The same at one point, as far as it is below `ceiling`: true, and element 0 of `out` is the fold; or false, and the
/// fold is at least the ceiling.
[[nodiscard]] bool fold_value_below(const PlaneView& planes, double ceiling, float x, float y, float z,
                                    Fold& out) noexcept;
[[nodiscard]] bool fold_gradient_below(const PlaneView& planes, double ceiling, float x, float y, float z,
                                       Fold& out) noexcept;

/// Where |∇c| is below `kFadeStart` nothing is carved; above `kFadeEnd` all is. A right-angled edge has |∇c| ≥ 1/√2 and
/// is carved in full; the middle of a thin block, where opposite faces cancel, is not.
inline constexpr float kFadeStart = 0.2f;
inline constexpr float kFadeEnd = 0.7f;

/// How deep the relief carves, D = amplitude · fade(|g|) · (1 − blend), and what the derivative of that depth is made of.
struct Carving {
  Lane step;  ///< D / |g|: the warped point is p + step · g.
  // The rest only with slopes.
  Lane length;         ///< |g|.
  Lane fade_gain;      ///< amplitude · fade'(|g|) · (1 − blend).
  Lane blend_gain;     ///< −amplitude · fade(|g|).
  Lane blend_by_g[3];  ///< ∂ blend / ∂ g.
  Lane blend_by_p[3];  ///< ∂ blend / ∂ p at fixed g, 1/m.
};

/// The carving at n <= kLanes points whose unwarped gradients are `gradient`; the relief is looked up at origin + (x, y,
/// z). Bits as for the folds.
void carve(const Warp& warp, const Vec3& origin, int n, const float* x, const float* y, const float* z,
           const Lane (&gradient)[3], Carving& out) noexcept;
void carve_with_slopes(const Warp& warp, const Vec3& origin, int n, const float* x, const float* y, const float* z,
                       const Lane (&gradient)[3], Carving& out) noexcept;

/// The gradients of the carved fold: `here` is the fold with its Hessians at the points, `there` the fold with its
/// gradients at the warped ones, `carving` has its slopes.
void carved_gradients(int n, const Fold& here, const Fold& there, const Carving& carving, Lane (&out)[3]) noexcept;

}  // namespace outcrop::lanes

#include "lanes.h"

#include <algorithm>
#include <cmath>

#include "outcrop/core/simd.h"

namespace outcrop::lanes {
namespace {

// Stands for 1/0: any two different floats are further apart than a rounding of 0.
constexpr float kSharp = 1e30f;
// Below this a direction is noise; the fade is 0 there anyway.
constexpr float kShortest = 1e-12f;

/// Order 0: values; 1: and gradients; 2: and Hessians. The same operations for the lower orders, so the same bits.
template <int Order>
[[gnu::always_inline]] inline void fold(const PlaneView& planes, int n, const float* __restrict x, const float* __restrict y,
                                        const float* __restrict z, Fold& __restrict out) {
  const float inverse = planes.rounding > 0.0f ? 1.0f / planes.rounding : kSharp;
  const float sixth = planes.rounding / 6.0f;
  float* __restrict const c = out.value;
  float* __restrict const gx = out.gradient[0];
  float* __restrict const gy = out.gradient[1];
  float* __restrict const gz = out.gradient[2];

  for (int i = 0; i < n; ++i) {
    c[i] = planes.nx[0] * x[i] + planes.ny[0] * y[i] + planes.nz[0] * z[i] + planes.d[0];
    if constexpr (Order >= 1) {
      gx[i] = planes.nx[0];
      gy[i] = planes.ny[0];
      gz[i] = planes.nz[0];
    }
    if constexpr (Order >= 2)
      for (auto& entry : out.hessian) entry[i] = 0.0f;
  }
  for (int plane = 1; plane < planes.count; ++plane) {
    const float nx = planes.nx[plane], ny = planes.ny[plane], nz = planes.nz[plane], d = planes.d[plane];
    for (int i = 0; i < n; ++i) {
      const float h = nx * x[i] + ny * y[i] + nz * z[i] + d;
      const float a = c[i];
      const float larger = h > a ? h : a;
      const float near = 1.0f - std::fabs(a - h) * inverse;
      const float k = near > 0.0f ? near : 0.0f;
      c[i] = larger + sixth * (k * k * k);
      if constexpr (Order >= 1) {
        // Written as a weighted sum, not as g + w (n − g): with a weight of 0 the other side drops out to the bit.
        const float half = 0.5f * (k * k);
        const float wh = h > a ? 1.0f - half : half;
        const float wa = 1.0f - wh;
        if constexpr (Order >= 2) {
          const float dx = gx[i] - nx, dy = gy[i] - ny, dz = gz[i] - nz, bend = k * inverse;
          out.hessian[0][i] = wa * out.hessian[0][i] + bend * (dx * dx);
          out.hessian[1][i] = wa * out.hessian[1][i] + bend * (dy * dy);
          out.hessian[2][i] = wa * out.hessian[2][i] + bend * (dz * dz);
          out.hessian[3][i] = wa * out.hessian[3][i] + bend * (dy * dz);
          out.hessian[4][i] = wa * out.hessian[4][i] + bend * (dx * dz);
          out.hessian[5][i] = wa * out.hessian[5][i] + bend * (dx * dy);
        }
        gx[i] = wa * gx[i] + wh * nx;
        gy[i] = wa * gy[i] + wh * ny;
        gz[i] = wa * gz[i] + wh * nz;
      }
    }
  }
}

/// Phase of origin + x in [0, 1]: in double, since the origin may be anywhere in the world.
OUTCROP_SIMD_CLONES
void phases(double origin, double per_metre, int n, const float* __restrict x, float* __restrict out) noexcept {
  for (int i = 0; i < n; ++i) {
    const double t = (origin + static_cast<double>(x[i])) * per_metre;
    out[i] = static_cast<float>(t - std::floor(t));
  }
}

struct Weights {
  Lane length, fade, fade_slope, share[3];
};

/// The triplanar weights |g_i| / Σ|g_j| (design decision 7: they sum to 1) and the fade.
OUTCROP_SIMD_CLONES
void weights(int n, const Lane (&g)[3], Weights& __restrict out) noexcept {
  for (int i = 0; i < n; ++i) {
    const float x = std::fabs(g[0][i]), y = std::fabs(g[1][i]), z = std::fabs(g[2][i]);
    const float length = std::sqrt(x * x + y * y + z * z);
    const float sum = x + y + z;
    const float scale = 1.0f / (sum > kShortest ? sum : kShortest);
    const float ramp = (length - kFadeStart) * (1.0f / (kFadeEnd - kFadeStart));
    const float below = ramp < 1.0f ? ramp : 1.0f;
    const float s = below > 0.0f ? below : 0.0f;
    out.length[i] = length > kShortest ? length : kShortest;
    out.fade[i] = s * s * (3.0f - 2.0f * s);
    out.fade_slope[i] = 6.0f * s * (1.0f - s) * (1.0f / (kFadeEnd - kFadeStart));
    out.share[0][i] = x * scale;
    out.share[1][i] = y * scale;
    out.share[2][i] = z * scale;
  }
}

/// Blend of the relief on the three axis planes; v is up on the vertical ones.
template <bool Slopes>
void blend(const Relief& relief, int n, const Lane (&phase)[3], const Lane (&g)[3], const Weights& w, Lane& blended,
           Carving& out) noexcept {
  for (int i = 0; i < n; ++i) {
    blended[i] = 1.0f;
    if (w.fade[i] > 0.0f) {
      const Relief::Sample yz = relief.at_phase<Slopes>(phase[1][i], phase[2][i]);
      const Relief::Sample xz = relief.at_phase<Slopes>(phase[0][i], phase[2][i]);
      const Relief::Sample xy = relief.at_phase<Slopes>(phase[0][i], phase[1][i]);
      const float sum = w.share[0][i] * yz.d + w.share[1][i] * xz.d + w.share[2][i] * xy.d;
      blended[i] = sum < 1.0f ? sum : 1.0f;
      if constexpr (Slopes) {
        // blend = Σ|g_j| d_j / Σ|g_j|, so ∂ blend / ∂ g_j = sign(g_j) (d_j − blend) / Σ|g_j|.
        const float scale = 1.0f / (std::fabs(g[0][i]) + std::fabs(g[1][i]) + std::fabs(g[2][i]));
        out.blend_by_g[0][i] = std::copysign(scale, g[0][i]) * (yz.d - sum);
        out.blend_by_g[1][i] = std::copysign(scale, g[1][i]) * (xz.d - sum);
        out.blend_by_g[2][i] = std::copysign(scale, g[2][i]) * (xy.d - sum);
        out.blend_by_p[0][i] = w.share[1][i] * xz.du + w.share[2][i] * xy.du;
        out.blend_by_p[1][i] = w.share[0][i] * yz.du + w.share[2][i] * xy.dv;
        out.blend_by_p[2][i] = w.share[0][i] * yz.dv + w.share[1][i] * xz.dv;
      }
    } else if constexpr (Slopes) {
      for (int axis = 0; axis < 3; ++axis) out.blend_by_g[axis][i] = out.blend_by_p[axis][i] = 0.0f;
    }
  }
}

}  // namespace

OUTCROP_SIMD_CLONES
void fold_values(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept {
  fold<0>(planes, n, x, y, z, out);
}
OUTCROP_SIMD_CLONES
void fold_gradients(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept {
  fold<1>(planes, n, x, y, z, out);
}
OUTCROP_SIMD_CLONES
void fold_hessians(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept {
  fold<2>(planes, n, x, y, z, out);
}

void carve(const Warp& warp, const Vec3& origin, int n, const float* x, const float* y, const float* z,
           const Lane (&gradient)[3], bool slopes, Carving& out) noexcept {
  const Relief& relief = *warp.relief;
  const double per_metre = 1.0 / relief.period();
  Lane phase[3], blended;
  phases(origin.x, per_metre, n, x, phase[0]);
  phases(origin.y, per_metre, n, y, phase[1]);
  phases(origin.z, per_metre, n, z, phase[2]);
  Weights w;
  weights(n, gradient, w);
  if (slopes)
    blend<true>(relief, n, phase, gradient, w, blended, out);
  else
    blend<false>(relief, n, phase, gradient, w, blended, out);
  const auto amplitude = static_cast<float>(warp.amplitude);
  for (int i = 0; i < n; ++i) {
    out.depth[i] = amplitude * w.fade[i] * (1.0f - blended[i]);
    out.step[i] = out.depth[i] / w.length[i];
  }
  if (!slopes) return;
  for (int i = 0; i < n; ++i) {
    out.length[i] = w.length[i];
    out.fade_gain[i] = amplitude * w.fade_slope[i] * (1.0f - blended[i]);
    out.blend_gain[i] = -amplitude * w.fade[i];
  }
}

}  // namespace outcrop::lanes

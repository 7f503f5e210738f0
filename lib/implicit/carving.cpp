#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "lanes.h"
#include "outcrop/core/simd.h"

namespace outcrop::lanes {
namespace {

// Below this a direction is noise; the fade is 0 there anyway.
constexpr float kShortest = 1e-12f;

// Each loop over n points is inlined twice: into what is built for every instruction set, and with n = 1.

/// Phase of origin + x in [0, 1]: in double, since the origin may be anywhere in the world.
[[gnu::always_inline]] inline void phases(double origin, double per_metre, int n, const float* __restrict x,
                                          float* __restrict out) {
  for (int i = 0; i < n; ++i) {
    const double t = (origin + static_cast<double>(x[i])) * per_metre;
    out[i] = static_cast<float>(t - std::floor(t));
  }
}

struct Weights {
  Lane length, fade, fade_slope, share[3];
};

/// The triplanar weights |g_i| / Σ|g_j| (design decision 7: they sum to 1) and the fade.
[[gnu::always_inline]] inline void weights(int n, const Lane (&g)[3], Weights& __restrict out) {
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

/// Where each phase falls among `count` pixels: how far away that pixel is, the place in it, and the weights of a
/// quadratic B-spline.
struct Taps {
  int offset[kLanes];
  Lane place, before, middle, after;
};

[[gnu::always_inline]] inline void locate(int n, const Lane& phase, int count, int stride, Taps& __restrict out) {
  const auto size = static_cast<float>(count);
  for (int i = 0; i < n; ++i) {
    const float at = phase[i] * size;
    const int pixel = static_cast<int>(at);
    const float a = at - static_cast<float>(pixel);
    out.offset[i] = pixel * stride;
    out.place[i] = a;
    out.before[i] = 0.5f * (1.0f - a) * (1.0f - a);
    out.middle[i] = 0.5f + a * (1.0f - a);
    out.after[i] = 0.5f * a * a;
  }
}

using Four [[gnu::vector_size(4 * sizeof(float))]] = float;

/// Of the first three; the fourth is 0 where columns are weighed.
[[gnu::always_inline]] inline float sum_of(const Four& v) { return (v[0] + v[2]) + v[1]; }

/// Three rows of four pixels.
struct Rows {
  Four below, at, above;

  [[gnu::always_inline]] Rows(const Relief::Pixels& pixels, const Taps& column, const Taps& row, int i) {
    const float* const first = pixels.first + row.offset[i] + column.offset[i];
    std::memcpy(&below, first, sizeof below);
    std::memcpy(&at, first + pixels.stride, sizeof at);
    std::memcpy(&above, first + 2 * pixels.stride, sizeof above);
  }
  /// The spline along v.
  [[gnu::always_inline]] Four value(const Taps& row, int i) const {
    return row.before[i] * below + row.middle[i] * at + row.after[i] * above;
  }
  /// Its derivative, a pixel.
  [[gnu::always_inline]] Four slope(const Taps& row, int i) const {
    const float b = row.place[i];
    return (1.0f - b) * (at - below) + b * (above - at);
  }
};

/// The weights of four pixels along u, and their derivatives; the fourth is 0.
[[gnu::always_inline]] inline Four columns(float a) {
  constexpr Four kConstant{0.5f, 0.5f, 0.0f, 0.0f}, kLinear{-1.0f, 1.0f, 0.0f, 0.0f}, kSquare{0.5f, -1.0f, 0.5f, 0.0f};
  return kConstant + a * (kLinear + a * kSquare);
}
[[gnu::always_inline]] inline Four column_slopes(float a) {
  constexpr Four kConstant{-1.0f, 1.0f, 0.0f, 0.0f}, kLinear{1.0f, -2.0f, 1.0f, 0.0f};
  return kConstant + a * kLinear;
}

/// Blend of the relief on the three axis planes, v up on the vertical ones; with Slopes its derivatives too.
template <bool Slopes>
[[gnu::always_inline]] inline void blend(const Relief& relief, int n, const Lane (&phase)[3], const Lane (&g)[3],
                                         const Weights& w, Lane& blended, Carving& out) {
  const Relief::Pixels pixels = relief.pixels();
  const auto u_scale = static_cast<float>(pixels.width / relief.period());
  const auto v_scale = static_cast<float>(pixels.height / relief.period());
  Taps column_x, column_y, row_y, row_z;
  const auto stride = static_cast<int>(pixels.stride);
  locate(n, phase[0], pixels.width, 1, column_x);
  locate(n, phase[1], pixels.width, 1, column_y);
  locate(n, phase[1], pixels.height, stride, row_y);
  locate(n, phase[2], pixels.height, stride, row_z);
  for (int i = 0; i < n; ++i) {
    const Rows yz(pixels, column_y, row_z, i), xz(pixels, column_x, row_z, i), xy(pixels, column_x, row_y, i);
    const Four on_yz = yz.value(row_z, i), on_xz = xz.value(row_z, i), on_xy = xy.value(row_y, i);
    const float share[3] = {w.share[0][i], w.share[1][i], w.share[2][i]};
    const Four along_x = columns(column_x.place[i]), along_y = columns(column_y.place[i]);
    const Four shared = share[1] * on_xz + share[2] * on_xy;
    const float total = sum_of(along_y * (share[0] * on_yz) + along_x * shared);
    blended[i] = total < 1.0f ? total : 1.0f;
    if constexpr (Slopes) {
      for (int axis = 0; axis < 3; ++axis) out.blend_by_g[axis][i] = out.blend_by_p[axis][i] = 0.0f;
      if (w.fade[i] <= 0.0f) continue;
      // blend = Σ|g_j| d_j / Σ|g_j|, so ∂ blend / ∂ g_j = sign(g_j) (d_j − blend) / Σ|g_j|.
      const float scale = 1.0f / (std::fabs(g[0][i]) + std::fabs(g[1][i]) + std::fabs(g[2][i]));
      out.blend_by_g[0][i] = std::copysign(scale, g[0][i]) * (sum_of(along_y * on_yz) - blended[i]);
      out.blend_by_g[1][i] = std::copysign(scale, g[1][i]) * (sum_of(along_x * on_xz) - blended[i]);
      out.blend_by_g[2][i] = std::copysign(scale, g[2][i]) * (sum_of(along_x * on_xy) - blended[i]);
      const Four slopes_y = column_slopes(column_y.place[i]), slopes_x = column_slopes(column_x.place[i]);
      out.blend_by_p[0][i] = u_scale * sum_of(slopes_x * shared);
      out.blend_by_p[1][i] = u_scale * sum_of(slopes_y * (share[0] * on_yz)) +
                             v_scale * sum_of(along_x * (share[2] * xy.slope(row_y, i)));
      out.blend_by_p[2][i] = v_scale * sum_of(along_y * (share[0] * yz.slope(row_z, i)) +
                                              along_x * (share[1] * xz.slope(row_z, i)));
    }
  }
}

template <bool Slopes>
[[gnu::always_inline]] inline void carve_points(const Warp& warp, const Vec3& origin, int n, const float* x,
                                                const float* y, const float* z, const Lane (&gradient)[3],
                                                Carving& out) {
  const Relief& relief = *warp.relief;
  const double per_metre = 1.0 / relief.period();
  Lane phase[3], blended;
  phases(origin.x, per_metre, n, x, phase[0]);
  phases(origin.y, per_metre, n, y, phase[1]);
  phases(origin.z, per_metre, n, z, phase[2]);
  Weights w;
  weights(n, gradient, w);
  blend<Slopes>(relief, n, phase, gradient, w, blended, out);
  const auto amplitude = static_cast<float>(warp.amplitude);
  for (int i = 0; i < n; ++i) out.step[i] = amplitude * w.fade[i] * (1.0f - blended[i]) / w.length[i];
  if constexpr (Slopes)
    for (int i = 0; i < n; ++i) {
      out.length[i] = w.length[i];
      out.fade_gain[i] = amplitude * w.fade_slope[i] * (1.0f - blended[i]);
      out.blend_gain[i] = -amplitude * w.fade[i];
    }
}

/// ∇b = G + (u·G) ∇D + D H (I − u uᵀ) G / t (rounded_polytope.cpp), with everything that H multiplies gathered into one
/// vector.
[[gnu::always_inline]] inline void gradients(int n, const Fold& here, const Fold& there, const Carving& carving,
                                             Lane (&__restrict out)[3]) {
  for (int i = 0; i < n; ++i) {
    const Vec3f far{there.gradient[0][i], there.gradient[1][i], there.gradient[2][i]};
    const Vec3f unit =
        Vec3f{here.gradient[0][i], here.gradient[1][i], here.gradient[2][i]} * (1.0f / carving.length[i]);
    const Vec3f by_g{carving.blend_by_g[0][i], carving.blend_by_g[1][i], carving.blend_by_g[2][i]};
    const Vec3f by_p{carving.blend_by_p[0][i], carving.blend_by_p[1][i], carving.blend_by_p[2][i]};
    const float along = far.x * unit.x + far.y * unit.y + far.z * unit.z;
    const Vec3f bent =
        along * (carving.fade_gain[i] * unit + carving.blend_gain[i] * by_g) + carving.step[i] * (far - along * unit);
    const Vec3f direct = far + along * carving.blend_gain[i] * by_p;
    const float xx = here.hessian[0][i], yy = here.hessian[1][i], zz = here.hessian[2][i];
    const float yz = here.hessian[3][i], xz = here.hessian[4][i], xy = here.hessian[5][i];
    out[0][i] = direct.x + (xx * bent.x + xy * bent.y + xz * bent.z);
    out[1][i] = direct.y + (xy * bent.x + yy * bent.y + yz * bent.z);
    out[2][i] = direct.z + (xz * bent.x + yz * bent.y + zz * bent.z);
  }
}

OUTCROP_SIMD_CLONES
void carve_many(const Warp& warp, const Vec3& origin, int n, const float* x, const float* y, const float* z,
                const Lane (&gradient)[3], Carving& out) noexcept {
  carve_points<false>(warp, origin, n, x, y, z, gradient, out);
}
OUTCROP_SIMD_CLONES
void carve_many_with_slopes(const Warp& warp, const Vec3& origin, int n, const float* x, const float* y, const float* z,
                            const Lane (&gradient)[3], Carving& out) noexcept {
  carve_points<true>(warp, origin, n, x, y, z, gradient, out);
}
OUTCROP_SIMD_CLONES
void many_gradients(int n, const Fold& here, const Fold& there, const Carving& carving, Lane (&out)[3]) noexcept {
  gradients(n, here, there, carving, out);
}

}  // namespace

void carve(const Warp& warp, const Vec3& origin, int n, const float* x, const float* y, const float* z,
           const Lane (&gradient)[3], Carving& out) noexcept {
  n == 1 ? carve_points<false>(warp, origin, 1, x, y, z, gradient, out)
         : carve_many(warp, origin, n, x, y, z, gradient, out);
}
void carve_with_slopes(const Warp& warp, const Vec3& origin, int n, const float* x, const float* y, const float* z,
                       const Lane (&gradient)[3], Carving& out) noexcept {
  n == 1 ? carve_points<true>(warp, origin, 1, x, y, z, gradient, out)
         : carve_many_with_slopes(warp, origin, n, x, y, z, gradient, out);
}
void carved_gradients(int n, const Fold& here, const Fold& there, const Carving& carving, Lane (&out)[3]) noexcept {
  n == 1 ? gradients(1, here, there, carving, out) : many_gradients(n, here, there, carving, out);
}

}  // namespace outcrop::lanes

#include "lanes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "outcrop/core/simd.h"

namespace outcrop::lanes {
namespace {

// Stands for 1/0: any two different floats are further apart than a rounding of 0.
constexpr float kSharp = 1e30f;
// Below this a direction is noise; the fade is 0 there anyway.
constexpr float kShortest = 1e-12f;

constexpr int kWidth = 16;
constexpr int kFewPoints = 8;  // So many are faster one by one.
/// Sixteen floats: one AVX-512 register, two of AVX2, four of SSE2. Lane by lane, so the bits are the same.
using Vector [[gnu::vector_size(kWidth * sizeof(float))]] = float;

[[gnu::always_inline]] inline Vector load(const float* from) {
  Vector v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
[[gnu::always_inline]] inline void store(float* to, const Vector& v) { std::memcpy(to, &v, sizeof v); }

/// Order 0: values; 1: and gradients; 2: and Hessians. The same operations for the lower orders, so the same bits.
/// Chains · 16 points at `first` of x, y, z; the accumulators stay in registers over all planes.
template <int Order, int Chains>
[[gnu::always_inline]] inline void fold_some(const PlaneView& planes, int first, const float* x, const float* y,
                                             const float* z, Fold& out) {
  const float inverse = planes.rounding > 0.0f ? 1.0f / planes.rounding : kSharp;
  const float sixth = planes.rounding / 6.0f;
  Vector px[Chains], py[Chains], pz[Chains], c[Chains], gx[Chains], gy[Chains], gz[Chains], bend[Chains][6];
  for (int j = 0; j < Chains; ++j) {
    px[j] = load(x + first + j * kWidth);
    py[j] = load(y + first + j * kWidth);
    pz[j] = load(z + first + j * kWidth);
    c[j] = planes.nx[0] * px[j] + planes.ny[0] * py[j] + planes.nz[0] * pz[j] + planes.d[0];
    gx[j] = Vector{} + planes.nx[0];
    gy[j] = Vector{} + planes.ny[0];
    gz[j] = Vector{} + planes.nz[0];
    for (Vector& entry : bend[j]) entry = Vector{};
  }
  for (int plane = 1; plane < planes.count; ++plane) {
    const float nx = planes.nx[plane], ny = planes.ny[plane], nz = planes.nz[plane], d = planes.d[plane];
    for (int j = 0; j < Chains; ++j) {
      const Vector h = nx * px[j] + ny * py[j] + nz * pz[j] + d;
      const Vector a = c[j];
      const Vector larger = h > a ? h : a;
      const Vector smaller = h > a ? a : h;
      const Vector near = 1.0f - (larger - smaller) * inverse;
      const Vector k = near > 0.0f ? near : Vector{};
      c[j] = larger + sixth * (k * k * k);
      if constexpr (Order >= 1) {
        // Written as a weighted sum, not as g + w (n − g): with a weight of 0 the other side drops out to the bit.
        const Vector half = 0.5f * (k * k);
        const Vector wh = h > a ? 1.0f - half : half;
        const Vector wa = 1.0f - wh;
        if constexpr (Order >= 2) {
          const Vector dx = gx[j] - nx, dy = gy[j] - ny, dz = gz[j] - nz, weight = k * inverse;
          bend[j][0] = wa * bend[j][0] + weight * (dx * dx);
          bend[j][1] = wa * bend[j][1] + weight * (dy * dy);
          bend[j][2] = wa * bend[j][2] + weight * (dz * dz);
          bend[j][3] = wa * bend[j][3] + weight * (dy * dz);
          bend[j][4] = wa * bend[j][4] + weight * (dx * dz);
          bend[j][5] = wa * bend[j][5] + weight * (dx * dy);
        }
        gx[j] = wa * gx[j] + wh * nx;
        gy[j] = wa * gy[j] + wh * ny;
        gz[j] = wa * gz[j] + wh * nz;
      }
    }
  }
  for (int j = 0; j < Chains; ++j) {
    const int at = first + j * kWidth;
    store(out.value + at, c[j]);
    if constexpr (Order >= 1) {
      store(out.gradient[0] + at, gx[j]);
      store(out.gradient[1] + at, gy[j]);
      store(out.gradient[2] + at, gz[j]);
    }
    if constexpr (Order >= 2)
      for (int entry = 0; entry < 6; ++entry) store(out.hessian[entry] + at, bend[j][entry]);
  }
}

/// One point: the same operations, but a plane that cannot change anything, to the bit, is passed over. Shorter than a
/// vector's chain of dependent steps, since most planes are.
template <int Order>
[[gnu::always_inline]] inline void fold_one(const PlaneView& planes, int at, float x, float y, float z, Fold& out) {
  const float inverse = planes.rounding > 0.0f ? 1.0f / planes.rounding : kSharp;
  const float sixth = planes.rounding / 6.0f;
  float c = planes.nx[0] * x + planes.ny[0] * y + planes.nz[0] * z + planes.d[0];
  float g[3] = {planes.nx[0], planes.ny[0], planes.nz[0]}, bend[6] = {};
  for (int plane = 1; plane < planes.count; ++plane) {
    const float n[3] = {planes.nx[plane], planes.ny[plane], planes.nz[plane]};
    const float h = n[0] * x + n[1] * y + n[2] * z + planes.d[plane];
    const bool above = h > c;
    const float larger = above ? h : c, smaller = above ? c : h;
    const float near = 1.0f - (larger - smaller) * inverse;
    if (!(near > 0.0f) && !above) continue;
    const float k = near > 0.0f ? near : 0.0f;
    c = larger + sixth * (k * k * k);
    if constexpr (Order >= 1) {
      const float half = 0.5f * (k * k);
      const float wh = above ? 1.0f - half : half;
      const float wa = 1.0f - wh;
      if constexpr (Order >= 2) {
        const float weight = k * inverse, dx = g[0] - n[0], dy = g[1] - n[1], dz = g[2] - n[2];
        const float squares[6] = {dx * dx, dy * dy, dz * dz, dy * dz, dx * dz, dx * dy};
        for (int entry = 0; entry < 6; ++entry) bend[entry] = wa * bend[entry] + weight * squares[entry];
      }
      for (int axis = 0; axis < 3; ++axis) g[axis] = wa * g[axis] + wh * n[axis];
    }
  }
  out.value[at] = c;
  if constexpr (Order >= 1)
    for (int axis = 0; axis < 3; ++axis) out.gradient[axis][at] = g[axis];
  if constexpr (Order >= 2)
    for (int entry = 0; entry < 6; ++entry) out.hessian[entry][at] = bend[entry];
}

template <int Order>
[[gnu::always_inline]] inline void fold(const PlaneView& planes, int n, const float* x, const float* y, const float* z,
                                        Fold& out) {
  // Hessians need so many registers that two chains are faster than four.
  constexpr int kChains = Order >= 2 ? 2 : 4;
  if (n == kLanes) {
    for (int first = 0; first < kLanes; first += kChains * kWidth)
      fold_some<Order, kChains>(planes, first, x, y, z, out);
    return;
  }
  if (n <= kFewPoints) {
    for (int i = 0; i < n; ++i) fold_one<Order>(planes, i, x[i], y[i], z[i], out);
    return;
  }
  alignas(64) Lane px, py, pz;  // The last vector may reach beyond the caller's points.
  const int padded = (n + kWidth - 1) / kWidth * kWidth;
  for (int i = 0; i < padded; ++i) {
    const int from = i < n ? i : 0;
    px[i] = x[from];
    py[i] = y[from];
    pz[i] = z[from];
  }
  for (int first = 0; first < padded; first += kWidth) fold_some<Order, 1>(planes, first, px, py, pz, out);
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

/// Where each phase falls among `count` pixels: the pixel, the place in it, and the weights of a quadratic B-spline.
struct Taps {
  int pixel[kLanes];
  Lane place, before, middle, after;
};

OUTCROP_SIMD_CLONES
void locate(int n, const Lane& phase, int count, Taps& __restrict out) noexcept {
  const auto size = static_cast<float>(count);
  for (int i = 0; i < n; ++i) {
    const float at = phase[i] * size;
    const int pixel = static_cast<int>(at);
    const float a = at - static_cast<float>(pixel);
    out.pixel[i] = pixel;
    out.place[i] = a;
    out.before[i] = 0.5f * (1.0f - a) * (1.0f - a);
    out.middle[i] = 0.5f + a * (1.0f - a);
    out.after[i] = 0.5f * a * a;
  }
}

using Four [[gnu::vector_size(4 * sizeof(float))]] = float;

/// Three rows of four pixels, weighted: the spline along v.
[[gnu::always_inline]] inline Four rows(const Relief::Pixels& pixels, const Taps& column, const Taps& row, int i) {
  const float* const first = pixels.first + static_cast<std::ptrdiff_t>(row.pixel[i]) * pixels.stride + column.pixel[i];
  Four below, at, above;
  std::memcpy(&below, first, sizeof below);
  std::memcpy(&at, first + pixels.stride, sizeof at);
  std::memcpy(&above, first + 2 * pixels.stride, sizeof above);
  return row.before[i] * below + row.middle[i] * at + row.after[i] * above;
}

/// The weights of four pixels along u; the fourth is 0.
[[gnu::always_inline]] inline Four columns(float a) {
  constexpr Four kConstant{0.5f, 0.5f, 0.0f, 0.0f}, kLinear{-1.0f, 1.0f, 0.0f, 0.0f}, kSquare{0.5f, -1.0f, 0.5f, 0.0f};
  return kConstant + a * (kLinear + a * kSquare);
}

/// Blend of the relief on the three axis planes; v is up on the vertical ones.
void blend(const Relief& relief, int n, const Lane (&phase)[3], const Weights& w, Lane& blended) noexcept {
  const Relief::Pixels pixels = relief.pixels();
  Taps column_x, column_y, row_y, row_z;
  locate(n, phase[0], pixels.width, column_x);
  locate(n, phase[1], pixels.width, column_y);
  locate(n, phase[1], pixels.height, row_y);
  locate(n, phase[2], pixels.height, row_z);
  for (int i = 0; i < n; ++i) {
    blended[i] = 1.0f;
    if (w.fade[i] <= 0.0f) continue;
    const Four along_x = columns(column_x.place[i]), along_y = columns(column_y.place[i]);
    const Four sum =
        along_y * (w.share[0][i] * rows(pixels, column_y, row_z, i)) +
        along_x * (w.share[1][i] * rows(pixels, column_x, row_z, i) + w.share[2][i] * rows(pixels, column_x, row_y, i));
    const float total = (sum[0] + sum[2]) + (sum[1] + sum[3]);
    blended[i] = total < 1.0f ? total : 1.0f;
  }
}

/// The derivatives of the blend.
void blend_slopes(const Relief& relief, int n, const Lane (&phase)[3], const Lane (&g)[3], const Weights& w,
                  const Lane& blended, Carving& out) noexcept {
  for (int i = 0; i < n; ++i) {
    for (int axis = 0; axis < 3; ++axis) out.blend_by_g[axis][i] = out.blend_by_p[axis][i] = 0.0f;
    if (w.fade[i] <= 0.0f) continue;
    const Relief::Sample yz = relief.at_phase(phase[1][i], phase[2][i]);
    const Relief::Sample xz = relief.at_phase(phase[0][i], phase[2][i]);
    const Relief::Sample xy = relief.at_phase(phase[0][i], phase[1][i]);
    // blend = Σ|g_j| d_j / Σ|g_j|, so ∂ blend / ∂ g_j = sign(g_j) (d_j − blend) / Σ|g_j|.
    const float scale = 1.0f / (std::fabs(g[0][i]) + std::fabs(g[1][i]) + std::fabs(g[2][i]));
    out.blend_by_g[0][i] = std::copysign(scale, g[0][i]) * (yz.d - blended[i]);
    out.blend_by_g[1][i] = std::copysign(scale, g[1][i]) * (xz.d - blended[i]);
    out.blend_by_g[2][i] = std::copysign(scale, g[2][i]) * (xy.d - blended[i]);
    out.blend_by_p[0][i] = w.share[1][i] * xz.du + w.share[2][i] * xy.du;
    out.blend_by_p[1][i] = w.share[0][i] * yz.du + w.share[2][i] * xy.dv;
    out.blend_by_p[2][i] = w.share[0][i] * yz.dv + w.share[1][i] * xz.dv;
  }
}

}  // namespace

OUTCROP_SIMD_CLONES
void fold_values(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept {
  fold<0>(planes, n, x, y, z, out);
}
OUTCROP_SIMD_CLONES
void fold_gradients(const PlaneView& planes, int n, const float* x, const float* y, const float* z,
                    Fold& out) noexcept {
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
  blend(relief, n, phase, w, blended);
  const auto amplitude = static_cast<float>(warp.amplitude);
  for (int i = 0; i < n; ++i) {
    out.depth[i] = amplitude * w.fade[i] * (1.0f - blended[i]);
    out.step[i] = out.depth[i] / w.length[i];
  }
  if (!slopes) return;
  blend_slopes(relief, n, phase, gradient, w, blended, out);
  for (int i = 0; i < n; ++i) {
    out.length[i] = w.length[i];
    out.fade_gain[i] = amplitude * w.fade_slope[i] * (1.0f - blended[i]);
    out.blend_gain[i] = -amplitude * w.fade[i];
  }
}

}  // namespace outcrop::lanes

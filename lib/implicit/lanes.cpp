#include "lanes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "outcrop/core/simd.h"

namespace outcrop::lanes {
namespace {

// Stands for 1/0: any two different floats are further apart than a rounding of 0.
constexpr float kSharp = 1e30f;
constexpr double kNoCeiling = std::numeric_limits<double>::infinity();
/// As many floats as a register holds. Lane by lane, so the bits are the same for any width.
template <int Width>
struct VectorOf {
  using Floats [[gnu::vector_size(Width * sizeof(float))]] = float;
  using Bits [[gnu::vector_size(Width * sizeof(float))]] = std::int32_t;
};
template <int Width>
using Vector = typename VectorOf<Width>::Floats;

template <class V>
[[gnu::always_inline]] inline V load(const float* from) {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <class V>
[[gnu::always_inline]] inline void store(float* to, const V& v) {
  std::memcpy(to, &v, sizeof v);
}
template <class V>
[[gnu::always_inline]] inline V larger_of(const V& a, const V& b) {
  return a > b ? a : b;
}
template <class V>
[[gnu::always_inline]] inline V absolute(const V& v) {
  using Bits = typename VectorOf<sizeof(V) / sizeof(float)>::Bits;
  return reinterpret_cast<V>(reinterpret_cast<Bits>(v) & 0x7fffffff);
}

/// Order 0: values; 1: and gradients; 2: and Hessians. The same operations for the lower orders, so the same bits.
/// Chains · Width points at `first` of x, y, z; the accumulators stay in registers over all planes.
template <int Order, int Width, int Chains>
[[gnu::always_inline]] inline void fold_some(const PlaneView& planes, int first, const float* x, const float* y,
                                             const float* z, Fold& out) {
  const float inverse = planes.rounding > 0.0f ? 1.0f / planes.rounding : kSharp;
  const float sixth = planes.rounding / 6.0f;
  using V = Vector<Width>;
  V px[Chains], py[Chains], pz[Chains], c[Chains], gx[Chains], gy[Chains], gz[Chains], bend[Chains][6];
  for (int j = 0; j < Chains; ++j) {
    px[j] = load<V>(x + first + j * Width);
    py[j] = load<V>(y + first + j * Width);
    pz[j] = load<V>(z + first + j * Width);
    c[j] = planes.nx[0] * px[j] + planes.ny[0] * py[j] + planes.nz[0] * pz[j] + planes.d[0];
    gx[j] = V{} + planes.nx[0];
    gy[j] = V{} + planes.ny[0];
    gz[j] = V{} + planes.nz[0];
    for (V& entry : bend[j]) entry = V{};
  }
  for (int plane = 1; plane < planes.count; ++plane) {
    const float nx = planes.nx[plane], ny = planes.ny[plane], nz = planes.nz[plane], d = planes.d[plane];
    for (int j = 0; j < Chains; ++j) {
      const V h = nx * px[j] + ny * py[j] + nz * pz[j] + d;
      const V a = c[j];
      const V k = larger_of(1.0f - absolute(h - a) * inverse, V{});
      c[j] = larger_of(h, a) + sixth * (k * k * k);
      if constexpr (Order >= 1) {
        // Written as a weighted sum, not as g + w (n − g): with a weight of 0 the other side drops out to the bit.
        const V half = 0.5f * (k * k);
        const V wh = h > a ? 1.0f - half : half;
        const V wa = 1.0f - wh;
        if constexpr (Order >= 2) {
          const V dx = gx[j] - nx, dy = gy[j] - ny, dz = gz[j] - nz, weight = k * inverse;
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
    const int at = first + j * Width;
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
/// vector's chain of dependent steps, since most planes are. False as soon as the fold, which grows from plane to plane,
/// is at the ceiling.
template <int Order>
inline bool fold_one(const PlaneView& planes, double ceiling, int at, float x, float y, float z, Fold& out) {
  const float inverse = planes.rounding > 0.0f ? 1.0f / planes.rounding : kSharp;
  const float sixth = planes.rounding / 6.0f;
  float c = planes.nx[0] * x + planes.ny[0] * y + planes.nz[0] * z + planes.d[0];
  float g[3] = {planes.nx[0], planes.ny[0], planes.nz[0]}, bend[6] = {};
  for (int plane = 1; plane < planes.count; ++plane) {
    const float n[3] = {planes.nx[plane], planes.ny[plane], planes.nz[plane]};
    const float h = n[0] * x + n[1] * y + n[2] * z + planes.d[plane];
    const float below = c - h;
    if (below * inverse >= 1.0f) continue;
    const float near = 1.0f - std::fabs(below) * inverse;
    const float k = near > 0.0f ? near : 0.0f;
    c = (below < 0.0f ? h : c) + sixth * (k * k * k);
    if (static_cast<double>(c) >= ceiling) return false;
    if constexpr (Order >= 1) {
      const float half = 0.5f * (k * k);
      const float wh = below < 0.0f ? 1.0f - half : half;
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
  return true;
}
template <int Order>
inline void fold_few(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) {
  for (int i = 0; i < n; ++i) fold_one<Order>(planes, kNoCeiling, i, x[i], y[i], z[i], out);
}

template <int Order, int Width>
[[gnu::always_inline]] inline void fold_many(const PlaneView& planes, int n, const float* x, const float* y,
                                             const float* z, Fold& out) {
  alignas(64) Lane px, py, pz;  // The last vector may reach beyond the caller's points.
  const int vectors = (n + Width - 1) / Width;
  if (vectors * Width > n) {
    const auto pad = [&](const float* from, Lane& to) {
      std::fill(std::copy_n(from, n, to), to + vectors * Width, from[0]);
      return to;
    };
    x = pad(x, px), y = pad(y, py), z = pad(z, pz);
  }
  // Several chains of dependent steps at once, as far as there are vectors, and registers for what each carries along.
  constexpr int kChains = Width == 16 ? (Order < 2 ? 4 : 2) : (Order == 0 ? 4 : 3 - Order);
  for (int done = 0; done < vectors;) {
    const int left = vectors - done, first = done * Width;
    if (left >= kChains) {
      fold_some<Order, Width, kChains>(planes, first, x, y, z, out), done += kChains;
    } else if (left == 3) {
      fold_some<Order, Width, std::min(kChains, 3)>(planes, first, x, y, z, out), done += 3;
    } else if (left == 2) {
      fold_some<Order, Width, std::min(kChains, 2)>(planes, first, x, y, z, out), done += 2;
    } else {
      fold_some<Order, Width, 1>(planes, first, x, y, z, out), done += 1;
    }
  }
}

OUTCROP_SIMD_WIDTHS(void many_values(const PlaneView& planes, int n, const float* x, const float* y, const float* z,
                                     Fold& out) noexcept,
                    fold_many<0, kWidth>(planes, n, x, y, z, out);)
OUTCROP_SIMD_WIDTHS(void many_gradients(const PlaneView& planes, int n, const float* x, const float* y, const float* z,
                                        Fold& out) noexcept,
                    fold_many<1, kWidth>(planes, n, x, y, z, out);)
OUTCROP_SIMD_WIDTHS(void many_hessians(const PlaneView& planes, int n, const float* x, const float* y, const float* z,
                                       Fold& out) noexcept,
                    fold_many<2, kWidth>(planes, n, x, y, z, out);)

}  // namespace

void fold_values(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept {
  n > kFewPoints ? many_values(planes, n, x, y, z, out) : fold_few<0>(planes, n, x, y, z, out);
}
void fold_gradients(const PlaneView& planes, int n, const float* x, const float* y, const float* z,
                    Fold& out) noexcept {
  n > kFewPoints ? many_gradients(planes, n, x, y, z, out) : fold_few<1>(planes, n, x, y, z, out);
}
void fold_hessians(const PlaneView& planes, int n, const float* x, const float* y, const float* z, Fold& out) noexcept {
  n > kFewPoints ? many_hessians(planes, n, x, y, z, out) : fold_few<2>(planes, n, x, y, z, out);
}
bool fold_value_below(const PlaneView& planes, double ceiling, float x, float y, float z, Fold& out) noexcept {
  return fold_one<0>(planes, ceiling, 0, x, y, z, out);
}
bool fold_gradient_below(const PlaneView& planes, double ceiling, float x, float y, float z, Fold& out) noexcept {
  return fold_one<1>(planes, ceiling, 0, x, y, z, out);
}

}  // namespace outcrop::lanes

#include "outcrop/implicit/polytope_union.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "outcrop/core/error.h"
#include "outcrop/core/simd.h"

namespace outcrop {
namespace {

constexpr std::size_t kChunk = 128;    // Points at a time.
constexpr std::size_t kRemembered = 16;  // Polytopes whose folds are kept from the first look to the second.

using Floats = std::array<float, kChunk>;
using Doubles = std::array<double, kChunk>;
constexpr Doubles kNoGrowth{};

// The loops over a chunk. Long ones are built for each instruction set; a few points are done on the spot.
constexpr std::size_t kFewPoints = 16;

/// Coordinates along one axis, relative to a polytope's centre.
[[gnu::always_inline]] inline void relative_loop(std::size_t n, const double* __restrict from, double centre,
                                                 float* __restrict out) {
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<float>(from[i] - centre);
}
OUTCROP_SIMD_CLONES
void relative_many(std::size_t n, const double* from, double centre, float* out) { relative_loop(n, from, centre, out); }
inline void relative(std::size_t n, const double* from, double centre, float* out) {
  n <= kFewPoints ? relative_loop(n, from, centre, out) : relative_many(n, from, centre, out);
}

/// Lowers `highest` to what a fold says that the value is at most.
[[gnu::always_inline]] inline void lower_loop(std::size_t n, const float* __restrict fold, double above,
                                              const double* __restrict growth, double* __restrict highest) {
  for (std::size_t i = 0; i < n; ++i) {
    const double value = static_cast<double>(fold[i]) + above - growth[i];
    highest[i] = value < highest[i] ? value : highest[i];
  }
}
OUTCROP_SIMD_CLONES
void lower_many(std::size_t n, const float* fold, double above, const double* growth, double* highest) {
  lower_loop(n, fold, above, growth, highest);
}
inline void lower(std::size_t n, const float* fold, double above, const double* growth, double* highest) {
  n <= kFewPoints ? lower_loop(n, fold, above, growth, highest) : lower_many(n, fold, above, growth, highest);
}

/// The points at which a polytope's value may be below `values` and no higher than `highest`; their number.
[[gnu::always_inline]] inline std::size_t choose_loop(std::size_t n, const float* __restrict fold, double slack,
                                                      const double* __restrict growth,
                                                      const double* __restrict highest,
                                                      const double* __restrict values,
                                                      std::uint8_t* __restrict chosen) {
  std::array<std::uint8_t, kChunk> may;
  unsigned any = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double lowest = static_cast<double>(fold[i]) - slack - growth[i];
    may[i] = lowest <= highest[i] && lowest < values[i];
    any |= may[i];
  }
  if (any == 0) return 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    chosen[count] = static_cast<std::uint8_t>(i);
    count += may[i];
  }
  return count;
}
OUTCROP_SIMD_CLONES
std::size_t choose_many(std::size_t n, const float* fold, double slack, const double* growth, const double* highest,
                        const double* values, std::uint8_t* chosen) {
  return choose_loop(n, fold, slack, growth, highest, values, chosen);
}
inline std::size_t choose(std::size_t n, const float* fold, double slack, const double* growth, const double* highest,
                          const double* values, std::uint8_t* chosen) {
  return n <= kFewPoints ? choose_loop(n, fold, slack, growth, highest, values, chosen)
                         : choose_many(n, fold, slack, growth, highest, values, chosen);
}

Box box_of(const Points& points) noexcept {
  const auto range = [](std::span<const double> values) {
    Interval result;
    for (const double v : values) result.include(v);
    return result;
  };
  const Interval x = range(points.x), y = range(points.y), z = range(points.z);
  return {{x.lo, y.lo, z.lo}, {x.hi, y.hi, z.hi}};
}

/// The fold at a chunk of points, and what rounding may add to it.
struct Folded {
  Floats value;
  double slack;
};

void fold_chunk(const PlacedKernel& polytope, const Points& points, const Box& box, Folded& out) noexcept {
  const auto& [kernel, position] = polytope;
  const std::size_t n = points.size();
  Floats x, y, z;
  relative(n, points.x.data(), position.x, x.data());
  relative(n, points.y.data(), position.y, y.data());
  relative(n, points.z.data(), position.z, z.data());
  kernel->folded(n, x.data(), y.data(), z.data(), out.value.data());
  const Vec3 farthest = glm::max(glm::abs(box.lo - position), glm::abs(box.hi - position));
  out.slack = 2.0 * kernel->rounding_slack(farthest.x + farthest.y + farthest.z);
}

void between_chunk(std::span<const PlacedKernel> polytopes, const Points& points, const double* growth,
                   std::span<const double> floors, std::span<double> values, std::span<Vec3> gradients) noexcept {
  const std::size_t n = points.size();
  const Box box = box_of(points);
  std::array<Folded, kRemembered> folds;
  Doubles highest;  // No point's result is above.
  std::copy(values.begin(), values.end(), highest.begin());
  const std::size_t remembered = std::min(polytopes.size(), kRemembered);
  for (std::size_t k = 0; k < remembered; ++k) {
    fold_chunk(polytopes[k], points, box, folds[k]);
    lower(n, folds[k].value.data(), polytopes[k].kernel->depth() + folds[k].slack, growth, highest.data());
  }
  // What is sure to end on the floor need not be known.
  for (std::size_t i = 0; i < floors.size(); ++i)
    if (highest[i] <= floors[i]) highest[i] = -std::numeric_limits<double>::infinity();
  std::array<std::uint8_t, kChunk> chosen;
  Floats x, y, z, value;
  std::array<Vec3f, kChunk> gradient;
  Folded own;
  for (std::size_t k = 0; k < polytopes.size(); ++k) {
    const auto& [kernel, position] = polytopes[k];
    if (k >= remembered) fold_chunk(polytopes[k], points, box, own);
    const Folded& fold = k < remembered ? folds[k] : own;
    if (kernel->depth() == 0.0 && gradients.empty()) {
      lower(n, fold.value.data(), 0.0, growth, values.data());
      continue;
    }
    const std::size_t count =
        choose(n, fold.value.data(), fold.slack, growth, highest.data(), values.data(), chosen.data());
    if (count == 0) continue;
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t i = chosen[j];
      x[j] = static_cast<float>(points.x[i] - position.x);
      y[j] = static_cast<float>(points.y[i] - position.y);
      z[j] = static_cast<float>(points.z[i] - position.z);
    }
    kernel->values(count, x.data(), y.data(), z.data(), value.data(), gradients.empty() ? nullptr : gradient.data());
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t i = chosen[j];
      const double candidate = static_cast<double>(value[j]) - growth[i];
      if (candidate >= values[i]) continue;
      values[i] = candidate;
      if (!gradients.empty()) gradients[i] = gradient[j];
    }
  }
  for (std::size_t i = 0; i < floors.size(); ++i)
    if (values[i] < floors[i] || highest[i] < floors[i]) values[i] = floors[i];
}

/// A chunk of one point, without the buffers: the same bits.
void between_one(std::span<const PlacedKernel> polytopes, const Vec3& p, double growth, double floor, double& value,
                 std::span<Vec3> gradient) noexcept {
  const PlacedKernel* lowest = nullptr;
  for (const PlacedKernel& polytope : polytopes) {
    const Vec3f local(p - polytope.position);
    const double candidate = polytope.kernel->value_below(value + growth, local.x, local.y, local.z) - growth;
    if (candidate >= value) continue;
    value = candidate;
    lowest = &polytope;
    if (value <= floor) break;
  }
  if (lowest && !gradient.empty() && value > floor) {
    const Vec3f local(p - lowest->position);
    float unused = 0.0f;
    Vec3f g;
    lowest->kernel->values(1, &local.x, &local.y, &local.z, &unused, &g);
    gradient[0] = g;
  }
  value = std::max(value, floor);
}

}  // namespace

void between_union(std::span<const PlacedKernel> polytopes, const Points& points, std::span<const double> growth,
                   std::span<const double> floors, std::span<double> values, std::span<Vec3> gradients) noexcept {
  if (points.size() == 1)
    return between_one(polytopes, points[0], growth.empty() ? 0.0 : growth[0],
                       floors.empty() ? -std::numeric_limits<double>::infinity() : floors[0], values[0], gradients);
  for (std::size_t first = 0; first < points.size(); first += kChunk) {
    const std::size_t n = std::min(kChunk, points.size() - first);
    between_chunk(polytopes, points.subspan(first, n), growth.empty() ? kNoGrowth.data() : &growth[first],
                  floors.empty() ? floors : floors.subspan(first, n), values.subspan(first, n),
                  gradients.empty() ? gradients : gradients.subspan(first, n));
  }
}

PolytopeUnion::PolytopeUnion(std::vector<PolytopeKernel> kernels, std::span<const Vec3> positions)
    : kernels_(std::move(kernels)) {
  require(!kernels_.empty() && kernels_.size() == positions.size(), "kernels", "at least 1, as many as positions",
          static_cast<double>(kernels_.size()));
  for (std::size_t k = 0; k < kernels_.size(); ++k) {
    polytopes_.push_back({&kernels_[k], positions[k]});
    lipschitz_ = std::max(lipschitz_, kernels_[k].lipschitz());
    depth_ = std::max(depth_, kernels_[k].depth());
  }
}

void PolytopeUnion::values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  std::ranges::fill(values, std::numeric_limits<double>::infinity());
  between_union(polytopes_, points, {}, {}, values, gradients);
}

void PolytopeUnion::between(const Points& points, std::span<const double> floors, std::span<double> values,
                            std::span<Vec3> gradients) const noexcept {
  between_union(polytopes_, points, {}, floors, values, gradients);
}

Interval PolytopeUnion::bound(const Box& box) const noexcept {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Interval result{kInfinity, kInfinity};
  for (const auto& [kernel, position] : polytopes_) result = min(result, kernel->bound(TurnedBox(box).moved(-position)));
  return result;
}

FieldPtr PolytopeUnion::narrow(const Box& box) const {
  std::vector<double> lowest;
  lowest.reserve(polytopes_.size());
  double highest = std::numeric_limits<double>::infinity();
  for (const auto& [kernel, position] : polytopes_) {
    const Interval bound = kernel->bound(TurnedBox(box).moved(-position));
    lowest.push_back(bound.lo);
    highest = std::min(highest, bound.hi);
  }
  std::vector<PolytopeKernel> kept;
  std::vector<Vec3> positions;
  for (std::size_t k = 0; k < polytopes_.size(); ++k) {
    if (lowest[k] > highest) continue;
    positions.push_back(polytopes_[k].position);
    kept.push_back(kernels_[k].narrow(TurnedBox(box).moved(-positions.back())));
  }
  return std::make_shared<PolytopeUnion>(std::move(kept), positions);
}

std::optional<Box> PolytopeUnion::support() const noexcept {
  Box result;
  for (const auto& [kernel, position] : polytopes_) {
    const std::optional<Box> local = kernel->support();
    if (!local) return std::nullopt;
    result = hull(result, local->moved(position));
  }
  return result;
}

}  // namespace outcrop

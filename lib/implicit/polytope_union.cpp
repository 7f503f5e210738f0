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

/// Coordinates along one axis, relative to a polytope's centre.
OUTCROP_SIMD_CLONES
void relative(std::size_t n, const double* __restrict from, double centre, float* __restrict out) {
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<float>(from[i] - centre);
}

/// Lowers `highest` to what a fold says that the value is at most.
OUTCROP_SIMD_CLONES
void lower(std::size_t n, const float* __restrict fold, double above, const double* __restrict growth,
           double* __restrict highest) {
  for (std::size_t i = 0; i < n; ++i) {
    const double value = static_cast<double>(fold[i]) + above - growth[i];
    highest[i] = value < highest[i] ? value : highest[i];
  }
}

/// One chunk of points before one of the polytopes.
struct Local {
  Floats x, y, z;

  Local(const Points& points, const Vec3& centre) noexcept {
    const std::size_t n = points.size();
    relative(n, points.x.data(), centre.x, x.data());
    relative(n, points.y.data(), centre.y, y.data());
    relative(n, points.z.data(), centre.z, z.data());
  }
};

Box box_of(const Points& points) noexcept {
  const auto range = [](std::span<const double> values) {
    Interval result;
    for (const double v : values) result.include(v);
    return result;
  };
  const Interval x = range(points.x), y = range(points.y), z = range(points.z);
  return {{x.lo, y.lo, z.lo}, {x.hi, y.hi, z.hi}};
}

void lower_chunk(std::span<const PlacedKernel> polytopes, const Points& points, const double* growth,
                 std::span<double> values, std::span<Vec3> gradients) noexcept {
  const std::size_t n = points.size();
  const TurnedBox box(box_of(points));
  std::array<Floats, kRemembered> folds;
  std::array<double, kRemembered> slacks;
  Doubles highest;  // No point's result is above.
  std::copy(values.begin(), values.end(), highest.begin());
  const std::size_t remembered = std::min(polytopes.size(), kRemembered);
  for (std::size_t k = 0; k < remembered; ++k) {
    const auto& [kernel, position] = polytopes[k];
    const Local local(points, position);
    kernel->folded(n, local.x.data(), local.y.data(), local.z.data(), folds[k].data());
    slacks[k] = 2.0 * kernel->rounding_slack(box.moved(-position));
    lower(n, folds[k].data(), kernel->depth() + slacks[k], growth, highest.data());
  }
  for (std::size_t k = 0; k < polytopes.size(); ++k) {
    const auto& [kernel, position] = polytopes[k];
    const Local local(points, position);
    Floats own;
    Floats& fold = k < remembered ? folds[k] : own;
    double slack = 0.0;
    if (k < remembered) {
      slack = slacks[k];
    } else {
      kernel->folded(n, local.x.data(), local.y.data(), local.z.data(), fold.data());
      slack = 2.0 * kernel->rounding_slack(box.moved(-position));
    }
    if (kernel->depth() == 0.0 && gradients.empty()) {
      lower(n, fold.data(), 0.0, growth, values.data());
      continue;
    }
    std::array<std::uint32_t, kChunk> chosen;
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      chosen[count] = static_cast<std::uint32_t>(i);
      const double lowest = static_cast<double>(fold[i]) - slack - growth[i];
      count += lowest <= highest[i] && lowest < values[i];
    }
    if (count == 0) continue;
    Floats x, y, z, value;
    std::array<Vec3f, kChunk> gradient;
    for (std::size_t j = 0; j < count; ++j) {
      x[j] = local.x[chosen[j]];
      y[j] = local.y[chosen[j]];
      z[j] = local.z[chosen[j]];
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
}

}  // namespace

void lower_to_union(std::span<const PlacedKernel> polytopes, const Points& points, std::span<const double> growth,
                    std::span<double> values, std::span<Vec3> gradients) noexcept {
  constexpr Doubles kNoGrowth{};
  for (std::size_t first = 0; first < points.size(); first += kChunk) {
    const std::size_t n = std::min(kChunk, points.size() - first);
    lower_chunk(polytopes, points.subspan(first, n), growth.empty() ? kNoGrowth.data() : &growth[first],
                values.subspan(first, n), gradients.empty() ? gradients : gradients.subspan(first, n));
  }
}

PolytopeUnion::PolytopeUnion(std::vector<PolytopeKernel> kernels, std::span<const Vec3> positions)
    : kernels_(std::move(kernels)) {
  require(!kernels_.empty() && kernels_.size() == positions.size(), "kernels", "at least 1, as many as positions",
          static_cast<double>(kernels_.size()));
  for (std::size_t k = 0; k < kernels_.size(); ++k) {
    polytopes_.push_back({&kernels_[k], positions[k]});
    lipschitz_ = std::max(lipschitz_, kernels_[k].lipschitz());
  }
}

void PolytopeUnion::values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  std::ranges::fill(values, std::numeric_limits<double>::infinity());
  lower_to_union(polytopes_, points, {}, values, gradients);
}

void PolytopeUnion::lower(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  lower_to_union(polytopes_, points, {}, values, gradients);
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

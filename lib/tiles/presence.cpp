#include "outcrop/tiles/presence.h"

#include <algorithm>
#include <utility>

namespace outcrop {
namespace {

constexpr double kSizeShare = 0.6;  // Of the order in which blocks are dropped; the rest is chance. At least a half.

}  // namespace

Criterion slope_at_least(double angle) {
  return [angle](const Anchor& anchor) { return anchor.slope >= angle; };
}

Criterion distance_between(double lo, double hi) {
  return [lo, hi](const Anchor& anchor) { return lo <= anchor.distance && anchor.distance <= hi; };
}

Criterion material_is(Label material) {
  return [material](const Anchor& anchor) { return anchor.material == material; };
}

Criterion all_of(std::vector<Criterion> criteria) {
  return [criteria = std::move(criteria)](const Anchor& anchor) {
    return std::ranges::all_of(criteria, [&](const Criterion& c) { return c(anchor); });
  };
}

Criterion any_of(std::vector<Criterion> criteria) {
  return [criteria = std::move(criteria)](const Anchor& anchor) {
    return std::ranges::any_of(criteria, [&](const Criterion& c) { return c(anchor); });
  };
}

Criterion none_of(std::vector<Criterion> criteria) {
  return [criteria = std::move(criteria)](const Anchor& anchor) {
    return std::ranges::none_of(criteria, [&](const Criterion& c) { return c(anchor); });
  };
}

bool present(const Criterion& criterion, std::span<const Anchor> anchors) {
  const auto agreeing = std::ranges::count_if(anchors, criterion);
  return !anchors.empty() && 2 * static_cast<std::size_t>(agreeing) >= anchors.size();
}

double mean_weight(const Weight& weight, std::span<const Anchor> anchors) {
  double sum = 0.0;
  for (const Anchor& anchor : anchors) sum += weight(anchor);
  return anchors.empty() ? 0.0 : sum / static_cast<double>(anchors.size());
}

double drop_threshold(double size_rank, double chance) noexcept {
  // A sum a X + b Y of two uniform numbers, a ≥ b, a + b = 1, is uniform again after its own distribution function.
  const double a = kSizeShare, b = 1.0 - kSizeShare;
  const double sum = a * size_rank + b * chance;
  if (sum < b) return sum * sum / (2.0 * a * b);
  if (sum <= a) return (sum - 0.5 * b) / a;
  return 1.0 - (1.0 - sum) * (1.0 - sum) / (2.0 * a * b);
}

}  // namespace outcrop

#include "outcrop/tiles/presence.h"

#include <algorithm>
#include <utility>

namespace outcrop {

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

}  // namespace outcrop

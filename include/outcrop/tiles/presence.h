/// Presence: where a block of the tile stands in the scene.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "outcrop/implicit/field.h"

namespace outcrop {

/// What the criteria look at: one anchor point of one replicated block.
struct Anchor {
  Vec3 position;      ///< World.
  double distance;    ///< f / |∇f| of the terrain, metres; negative in rock.
  double slope;       ///< Angle between ∇f and the vertical, radians: 0 flat ground, π/2 wall.
  Label material;     ///< Of the terrain there.
};

/// One yes-or-no criterion. Pure: the same anchor, the same answer.
using Criterion = std::function<bool(const Anchor&)>;

[[nodiscard]] Criterion slope_at_least(double angle);
[[nodiscard]] Criterion distance_between(double lo, double hi);
[[nodiscard]] Criterion material_is(Label material);
[[nodiscard]] Criterion all_of(std::vector<Criterion> criteria);
[[nodiscard]] Criterion any_of(std::vector<Criterion> criteria);
[[nodiscard]] Criterion none_of(std::vector<Criterion> criteria);

/// Half or more of the anchors satisfy the criterion (Paris et al. 2020, section 5). False without anchors.
[[nodiscard]] bool present(const Criterion& criterion, std::span<const Anchor> anchors);

}  // namespace outcrop

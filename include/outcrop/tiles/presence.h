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

/// How much of the rock stands at an anchor, [0, 1]: 1 all blocks, 0 none, between them the larger ones.
using Weight = std::function<double(const Anchor&)>;

/// The mean over the anchors. 0 without any.
[[nodiscard]] double mean_weight(const Weight& weight, std::span<const Anchor> anchors);

/// The weight below which a block is dropped: small ones go first, in an order that chance loosens.
///
/// @param size_rank  Share of the tile's blocks that are larger than it, [0, 1].  @param chance  Uniform in [0, 1), of
/// this copy of the block. @return in [0, 1), uniform where both are: a weight of 0.3 leaves three blocks in ten.
[[nodiscard]] double drop_threshold(double size_rank, double chance) noexcept;

/// Half or more of the anchors satisfy the criterion (Paris et al. 2020, section 5). False without anchors.
[[nodiscard]] bool present(const Criterion& criterion, std::span<const Anchor> anchors);

}  // namespace outcrop

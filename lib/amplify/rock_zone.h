/// Where rock may replace the ground, and how far: the two envelopes of a heightfield.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "outcrop/core/task.h"
#include "outcrop/implicit/field.h"
#include "outcrop/terrain/heightfield.h"
#include "outcrop/terrain/raster_layer.h"

namespace outcrop {

struct RockZoneOptions {
  Vec2 lo{0.0}, hi{0.0};  ///< Rectangle that is covered, map coordinates.
  double slope = 0.0;     ///< Radians; ground flatter than this is left alone.
  double reach = 1.0;     ///< Largest horizontal distance by which the ground may advance, metres, > 0.
  double recess = 1.0;    ///< It may withdraw by this many times the reach, ≥ 0.
  std::function<double(const Vec3&)> reach_at;  ///< At a point of the surface, [0, reach]; 0: left alone. Null: `reach`.
  double spacing = 1.0;   ///< Of the raster that the rim is drawn on, metres, > 0.
  double block_size = 0.0;  ///< Metres; ledges narrower than this count as part of the wall. 0: none do.
  /// How much rock a point of the surface may have, [0, 1]; 0: left alone. Both envelopes follow it. Null: 1
  /// everywhere.
  std::function<double(const Vec3&)> weight_at;
  /// The same of the rock at that point, whose neighbours' blocks may reach beyond their own beds: the largest within half
  /// the reach counts. Null: 1 everywhere.
  std::function<double(const Vec3&)> rock_weight_at;
  double rim = 0.0;  ///< Metres from the rim of the steep ground over which the weight grows from 0, ≥ 0.
};

/// The ground of the zone that is next to a place. Copies are cheap.
class NearestGround {
 public:
  NearestGround() = default;
  /// @param nodes  One for each node of the layer's raster, rows from the south.
  NearestGround(int width, int height, const Vec2& lo, double spacing, std::vector<Vec2> nodes)
      : width_(width),
        height_(height),
        lo_(lo),
        spacing_(spacing),
        nodes_(std::make_shared<std::vector<Vec2>>(std::move(nodes))) {}

  /// To within a node of the envelopes' raster; p itself where none is within reach.
  [[nodiscard]] Vec2 at(const Vec2& p) const noexcept;

 private:
  int width_ = 0, height_ = 0;
  Vec2 lo_{0.0};
  double spacing_ = 1.0;
  std::shared_ptr<const std::vector<Vec2>> nodes_;
};

/// On steep ground the surface may lie anywhere between h − recess and h + advance.
///
/// Both envelopes are the lowest and the highest ground within `reach`: on a wall they are the wall moved back and forth by it.
/// At its top the advance does not leave the level of the plateau; at its foot the recess goes on below the floor, where blocks
/// stand as well. They grow from 0 at the rim of the steep ground, and are exactly 0 over nodata and over ground that is not
/// steep, unless it is a ledge of the wall narrower than a block.
struct RockZone {
  RasterLayer recess;   ///< ≥ 0, metres.
  RasterLayer advance;  ///< ≥ 0, metres.
  RasterLayer nearby;   ///< > 0 where steep ground lies within reach.
  RasterLayer weight;   ///< How much rock the ground may have, [0, 1]; meaningful where `weighted`.
  RasterLayer rim;      ///< The part of it that depends on the distance to the rim, [0, 1].
  NearestGround ground;
  bool weighted = false;  ///< The weight is not 1 everywhere.
  double slope = 0.0;   ///< The threshold, radians.
  bool empty = true;    ///< No steep ground at all.
};

/// Cost: O(nodes of the raster); O(12² · recess²) more for each of a coarser raster's nodes near steep ground, 12 of them a reach.
[[nodiscard]] RockZone make_rock_zone(const Heightfield& heightfield, const RockZoneOptions& options, const Task& task = {});

/// terrain + factor · layer(x, y): the terrain withdrawn (factor > 0) or advanced (< 0).
[[nodiscard]] FieldPtr displaced_terrain(FieldPtr terrain, RasterLayer layer, double factor);

/// max(f − advance, min(f + recess, rock)): rock between the envelopes, the terrain's own bits where both are 0.
///
/// Labels: rock's own where rock is the surface, else `strata`'s on ground well steeper than the threshold, `ground` elsewhere.
[[nodiscard]] FieldPtr rock_on_terrain(FieldPtr terrain, RockZone zone, FieldPtr rock, FieldPtr strata, Label ground);

}  // namespace outcrop

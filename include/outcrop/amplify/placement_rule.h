/// Rules that say where rock may stand, and how much of it.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"
#include "outcrop/terrain/heightfield.h"

namespace outcrop {

/// A tree of rules. Each has a value in [0, 1] at a place: 0 no rock, 1 all of it, between them the larger blocks.
///
/// A range is 0 outside of [lo, hi] and rises to `density` within `soft` of its ends, as a region does behind its
/// border. All is the least of its parts, Any the largest, Not 1 minus its only part.
struct PlacementRule {
  enum class Kind {
    Slope,      ///< Radians, of the ground at `scale`.
    Aspect,     ///< Radians clockwise from north: from lo clockwise to hi, where the ground falls to, at `scale`.
    Curvature,  ///< 1/m, of the ground at `scale`: > 0 on ridges and edges, < 0 in hollows.
    Altitude,   ///< Metres.
    Water,      ///< Metres above water_level.
    Distance,   ///< Metres from the surface, negative in rock. Says nothing of the ground itself.
    Mask,       ///< An image over the terrain: white 1, black 0.
    Polygon,    ///< On the map, metres from the terrain's south-west corner.
    Box,        ///< Metres from that corner, and elevations.
    Sphere,
    Material,
    All,
    Any,
    Not,
  };
  Kind kind = Kind::All;
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
  double soft = 0.0;     ///< In the unit of the range, or metres behind a border; ≥ 0.
  double scale = 0.0;    ///< Metres: how far apart the ground is looked at; 0: a block.
  double density = 1.0;  ///< The rule's largest value, (0, 1].
  double water_level = 0.0;
  std::filesystem::path image;
  std::vector<Vec2> polygon;  ///< At least three corners; sides do not cross.
  Box box;
  Vec3 centre{0.0};
  double radius = 0.0;
  std::vector<Label> materials;
  std::vector<PlacementRule> parts;
  std::string place;  ///< `file:line:column`, for what only the terrain can tell.
};

/// What rules look at.
struct RuleSite {
  Vec3 position{0.0};  ///< World: a point of the surface, or an anchor of a block.
  Vec2 ground{0.0};    ///< Where slope, aspect and curvature are taken: the rock's surface next to an anchor.
  std::optional<double> distance;  ///< Of an anchor to the surface, metres; none: the ground itself.
  Label material = 0;
};

/// A rule's value at a site. Pure.
using RuleValue = std::function<double(const RuleSite&)>;

/// @param block_size  Metres, > 0: the scale of rules that name none.
/// @throws InputError naming the rule's place for an image that does not fit the terrain and a water level outside of
/// it.
[[nodiscard]] RuleValue rule_value(const PlacementRule& rule, const Heightfield& heightfield, double block_size);

/// Two sides of a closed polygon that cross or touch without being neighbours, by index; nothing when it is simple.
/// Cost: O(sides²).
[[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> crossing_sides(const std::vector<Vec2>& polygon);

}  // namespace outcrop

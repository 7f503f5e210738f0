#include "outcrop/amplify/placement_rule.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "outcrop/core/error.h"
#include "outcrop/core/image.h"
#include "outcrop/terrain/map_image.h"

namespace outcrop {
namespace {

using Kind = PlacementRule::Kind;
/// Nothing: the rule cannot say.
using MaybeValue = std::function<std::optional<double>(const RuleSite&)>;

constexpr int kCircle = 8;            // Points about a place at which curvature compares the ground.
constexpr double kLevelSlope = 1e-3;  // Tangent below which the ground has no aspect.

/// 0 outside, rising to 1 within `soft` behind the border.
double soft_step(double inside, double soft) {
  if (!(inside >= 0.0)) return 0.0;
  return soft > 0.0 ? std::min(inside / soft, 1.0) : 1.0;
}

double soft_range(double value, const PlacementRule& rule) {
  return soft_step(std::min(value - rule.lo, rule.hi - value), rule.soft);
}

/// The ground's gradient by differences over `scale`.
Vec2 gradient_at(const Heightfield& heightfield, const Vec2& p, double scale) {
  const double half = 0.5 * scale;
  return Vec2(heightfield.at(p.x + half, p.y).h - heightfield.at(p.x - half, p.y).h,
              heightfield.at(p.x, p.y + half).h - heightfield.at(p.x, p.y - half).h) /
         scale;
}

/// Twice the height over the mean of a circle, over its radius squared: the mean curvature of a gentle cap.
double curvature_at(const Heightfield& heightfield, const Vec2& p, double scale) {
  const double radius = 0.5 * scale;
  double mean = 0.0;
  for (int k = 0; k < kCircle; ++k) {
    const double angle = 2.0 * kPi * k / kCircle;
    mean += heightfield.at(p.x + radius * std::cos(angle), p.y + radius * std::sin(angle)).h / kCircle;
  }
  return 2.0 * (heightfield.at(p.x, p.y).h - mean) / (radius * radius);
}

/// Signed distance to a polygon's border, positive inside.
double depth_in_polygon(const std::vector<Vec2>& polygon, const Vec2& p) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 a = polygon[j], b = polygon[i];
    const double t = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
    nearest = std::min(nearest, glm::length(p - (a + t * (b - a))));
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside ? nearest : -nearest;
}

double depth_in_box(const Box& box, const Vec3& p) {
  const Vec3 depth = glm::min(p - box.lo, box.hi - p);
  return std::min({depth.x, depth.y, depth.z});
}

/// The angle from `from` clockwise, [0, 2π).
double clockwise(double from, double angle) {
  const double turn = std::fmod(angle - from, 2.0 * kPi);
  return turn < 0.0 ? turn + 2.0 * kPi : turn;
}

MaybeValue leaf(const PlacementRule& rule, const Heightfield& heightfield, double block_size) {
  const double scale = rule.scale > 0.0 ? rule.scale : block_size;
  const Vec3 corner(heightfield.lo(), 0.0);
  switch (rule.kind) {
    case Kind::Slope:
      return [=](const RuleSite& s) {
        return soft_range(std::atan(glm::length(gradient_at(heightfield, s.ground, scale))), rule);
      };
    case Kind::Aspect:
      return [=](const RuleSite& s) {
        const Vec2 g = gradient_at(heightfield, s.ground, scale);
        if (glm::length(g) < kLevelSlope) return 0.0;
        const double turn = clockwise(rule.lo, std::atan2(-g.x, -g.y)), width = clockwise(rule.lo, rule.hi);
        if (width == 0.0) return 1.0;
        return turn > width ? 0.0 : soft_step(std::min(turn, width - turn), rule.soft);
      };
    case Kind::Curvature:
      return [=](const RuleSite& s) { return soft_range(curvature_at(heightfield, s.ground, scale), rule); };
    case Kind::Altitude:
      return [=](const RuleSite& s) { return soft_range(s.position.z, rule); };
    case Kind::Water: {
      const Interval heights = heightfield.height_bound(heightfield.lo(), heightfield.hi());
      if (!heights.contains(rule.water_level))
        throw InputError(rule.place + ": \"water_level\": expected an elevation of the terrain, " +
                         std::to_string(std::lround(heights.lo)) + " to " + std::to_string(std::lround(heights.hi)) +
                         " m, got " + std::to_string(std::lround(rule.water_level)));
      return [=](const RuleSite& s) { return soft_range(s.position.z - rule.water_level, rule); };
    }
    case Kind::Distance:
      return [=](const RuleSite& s) -> std::optional<double> {
        if (!s.distance) return std::nullopt;
        return soft_range(*s.distance, rule);
      };
    case Kind::Mask: {
      Image image = read_image(rule.image);
      if (const std::optional<std::string> wanted = MapImage::misfit(image, heightfield))
        throw InputError(rule.place + ": \"mask\": expected " + *wanted + ", got " + std::to_string(image.width) +
                         " x " + std::to_string(image.height));
      const auto mask = std::make_shared<const MapImage>(std::move(image), heightfield);
      return [=](const RuleSite& s) { return std::clamp(mask->brightness(s.position.x, s.position.y), 0.0, 1.0); };
    }
    case Kind::Polygon:
      return [=](const RuleSite& s) {
        return soft_step(depth_in_polygon(rule.polygon, Vec2(s.position - corner)), rule.soft);
      };
    case Kind::Box:
      return [=](const RuleSite& s) { return soft_step(depth_in_box(rule.box, s.position - corner), rule.soft); };
    case Kind::Sphere:
      return [=](const RuleSite& s) {
        return soft_step(rule.radius - glm::length(s.position - corner - rule.centre), rule.soft);
      };
    default:
      return [=](const RuleSite& s) { return std::ranges::count(rule.materials, s.material) > 0 ? 1.0 : 0.0; };
  }
}

MaybeValue maybe_value(const PlacementRule& rule, const Heightfield& heightfield, double block_size);

/// Without the density. Parts that cannot say are left out of an All; of an Any they leave everything open.
MaybeValue dense_value(const PlacementRule& rule, const Heightfield& heightfield, double block_size) {
  std::vector<MaybeValue> parts;
  for (const PlacementRule& part : rule.parts) parts.push_back(maybe_value(part, heightfield, block_size));
  switch (rule.kind) {
    case Kind::All:
      return [parts](const RuleSite& s) {
        std::optional<double> least;
        for (const MaybeValue& part : parts) {
          const std::optional<double> value = part(s);
          if (value) least = std::min(least.value_or(1.0), *value);
          if (least == 0.0) break;
        }
        return least;
      };
    case Kind::Any:
      return [parts](const RuleSite& s) -> std::optional<double> {
        double largest = 0.0;
        for (const MaybeValue& part : parts) {
          const std::optional<double> value = part(s);
          if (!value) return std::nullopt;
          largest = std::max(largest, *value);
        }
        return largest;
      };
    case Kind::Not:
      return [part = parts.at(0)](const RuleSite& s) -> std::optional<double> {
        const std::optional<double> value = part(s);
        if (!value) return std::nullopt;
        return 1.0 - *value;
      };
    default:
      return leaf(rule, heightfield, block_size);
  }
}

MaybeValue maybe_value(const PlacementRule& rule, const Heightfield& heightfield, double block_size) {
  MaybeValue dense = dense_value(rule, heightfield, block_size);
  if (rule.density == 1.0) return dense;
  return [dense = std::move(dense), density = rule.density](const RuleSite& s) {
    std::optional<double> value = dense(s);
    if (value) *value *= density;
    return value;
  };
}

/// Twice the signed area of a triangle.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Do two closed segments share a point?
bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto within = [](const Vec2& p, const Vec2& q, const Vec2& r) {
    return std::min(p.x, q.x) <= r.x && r.x <= std::max(p.x, q.x) && std::min(p.y, q.y) <= r.y &&
           r.y <= std::max(p.y, q.y);
  };
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0.0) != (abd > 0.0)) && ((cda > 0.0) != (cdb > 0.0)) && abc != 0.0 && abd != 0.0 && cda != 0.0 &&
      cdb != 0.0)
    return true;
  return (abc == 0.0 && within(a, b, c)) || (abd == 0.0 && within(a, b, d)) || (cda == 0.0 && within(c, d, a)) ||
         (cdb == 0.0 && within(c, d, b));
}

}  // namespace

RuleValue rule_value(const PlacementRule& rule, const Heightfield& heightfield, double block_size) {
  return [value = maybe_value(rule, heightfield, block_size)](const RuleSite& s) { return value(s).value_or(1.0); };
}

std::optional<std::pair<std::size_t, std::size_t>> crossing_sides(const std::vector<Vec2>& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // Neighbours share a corner.
      if (meet(polygon[i], polygon[i + 1], polygon[j], polygon[(j + 1) % n])) return std::pair(i, j);
    }
  return std::nullopt;
}

}  // namespace outcrop

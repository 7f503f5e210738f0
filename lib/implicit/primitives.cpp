#include "outcrop/implicit/primitives.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

/// A distance and its gradient.
struct Distance {
  double value;
  Vec3 gradient;
};

/// A Shape is a value with `Distance at(p)`, an exact signed distance (so L = 1), and `std::optional<Box> support()`.
template <class Shape>
class Solid final : public Field {
 public:
  explicit Solid(const Shape& shape) : shape_(shape) {}

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Distance distance = shape_.at(points[i]);
      values[i] = distance.value;
      if (!gradients.empty()) gradients[i] = distance.gradient;
    }
  }
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }
  [[nodiscard]] std::optional<Box> support() const noexcept override { return shape_.support(); }

 private:
  Shape shape_;
};

template <class Shape>
[[nodiscard]] FieldPtr solid(const Shape& shape) {
  return std::make_shared<Solid<Shape>>(shape);
}

void require_finite(const Vec3& v, std::string_view name) {
  for (int axis = 0; axis < 3; ++axis) require(std::isfinite(v[axis]), name, "finite", v[axis]);
}

void require_positive(double v, std::string_view name) {
  require(v > 0.0 && std::isfinite(v), name, "> 0 and finite", v);
}

/// v / |v|, or any unit vector where v is 0.
[[nodiscard]] Vec3 direction(const Vec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : Vec3(0, 0, 1);
}

/// The nearest point to p on the segment a b.
[[nodiscard]] Vec3 nearest(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0.0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return a + t * along;
}

struct Ball {
  Vec3 centre;
  double radius;
  [[nodiscard]] Distance at(const Vec3& p) const { return {glm::length(p - centre) - radius, direction(p - centre)}; }
  [[nodiscard]] std::optional<Box> support() const { return Box{centre, centre}.grown(radius); }
};

struct Brick {
  Vec3 centre;
  Vec3 half;  ///< Of the box whose offset by `rounding` this is.
  double rounding;

  [[nodiscard]] Distance at(const Vec3& p) const {
    const Vec3 from = p - centre;
    const Vec3 side{std::copysign(1.0, from.x), std::copysign(1.0, from.y), std::copysign(1.0, from.z)};
    const Vec3 beyond = glm::abs(from) - half;
    const Vec3 outside = glm::max(beyond, Vec3(0.0));
    const double length = glm::length(outside);
    if (length > 0.0) return {length - rounding, side * outside / length};
    int axis = beyond.x >= beyond.y ? 0 : 1;
    if (beyond.z > beyond[axis]) axis = 2;
    Vec3 gradient{0.0};
    gradient[axis] = side[axis];
    return {beyond[axis] - rounding, gradient};
  }
  [[nodiscard]] std::optional<Box> support() const { return Box{centre - half, centre + half}.grown(rounding); }
};

struct HalfSpace {
  Plane plane;
  [[nodiscard]] Distance at(const Vec3& p) const { return {plane.distance(p), plane.normal}; }
  [[nodiscard]] std::optional<Box> support() const { return std::nullopt; }
};

struct Slab {
  double floor, ceiling;
  [[nodiscard]] Distance at(const Vec3& p) const {
    const bool upper = p.z - ceiling >= floor - p.z;
    return upper ? Distance{p.z - ceiling, {0, 0, 1}} : Distance{floor - p.z, {0, 0, -1}};
  }
  [[nodiscard]] std::optional<Box> support() const { return std::nullopt; }
};

struct Capsule {
  Vec3 a, b;
  double radius;
  [[nodiscard]] Distance at(const Vec3& p) const {
    const Vec3 from = p - nearest(p, a, b);
    return {glm::length(from) - radius, direction(from)};
  }
  [[nodiscard]] std::optional<Box> support() const { return Box{glm::min(a, b), glm::max(a, b)}.grown(radius); }
};

/// Position in the plane through an axis: how far along, how far away, and in which direction.
struct Axial {
  double along, away;
  Vec3 outwards;
};

[[nodiscard]] Axial axial(const Vec3& from, const Vec3& axis) {
  const double along = glm::dot(from, axis);
  const Vec3 across = from - along * axis;
  const double away = glm::length(across);
  if (away > 0.0) return {along, away, across / away};
  const Vec3 other = std::abs(axis.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  return {along, 0.0, glm::normalize(glm::cross(axis, other))};
}

struct Cylinder {
  Vec3 centre, axis;
  double half, radius;

  [[nodiscard]] Distance at(const Vec3& p) const {
    const Axial place = axial(p - centre, axis);
    const Vec3 end = std::copysign(1.0, place.along) * axis;
    const double over = std::abs(place.along) - half, out = place.away - radius;
    if (over > 0.0 && out > 0.0) {
      const double length = std::hypot(over, out);
      return {length, (over * end + out * place.outwards) / length};
    }
    return over > out ? Distance{over, end} : Distance{out, place.outwards};
  }
  [[nodiscard]] std::optional<Box> support() const {
    const Vec3 reach = half * glm::abs(axis) + radius * glm::sqrt(glm::max(Vec3(1.0) - axis * axis, Vec3(0.0)));
    return Box{centre - reach, centre + reach}.grown(1e-9 * radius);
  }
};

struct Torus {
  Vec3 centre, axis;
  double major, minor;

  [[nodiscard]] Distance at(const Vec3& p) const {
    const Axial place = axial(p - centre, axis);
    const double out = place.away - major;
    const double length = std::hypot(place.along, out);
    const Vec3 gradient = length > 0.0 ? (place.along * axis + out * place.outwards) / length : axis;
    return {length - minor, gradient};
  }
  [[nodiscard]] std::optional<Box> support() const { return Box{centre, centre}.grown(major + minor); }
};

}  // namespace

FieldPtr sphere(const Vec3& centre, double radius) {
  require_finite(centre, "centre");
  require_positive(radius, "radius");
  return solid(Ball{centre, radius});
}

FieldPtr box_solid(const Box& box, double rounding) {
  require_finite(box.lo, "box");
  require_finite(box.hi, "box");
  const Vec3 size = box.size();
  const double thinnest = std::min({size.x, size.y, size.z});
  require(thinnest > 0.0, "box", "edges > 0", thinnest);
  require(rounding >= 0.0 && rounding <= 0.5 * thinnest, "rounding", "0 to half of the box's shortest edge", rounding);
  return solid(Brick{box.centre(), 0.5 * size - Vec3(rounding), rounding});
}

FieldPtr half_space(const Plane& plane) {
  require_finite(plane.normal, "normal");
  require(std::abs(glm::length(plane.normal) - 1.0) < 1e-6, "normal", "a unit vector", glm::length(plane.normal));
  require(std::isfinite(plane.offset), "offset", "finite", plane.offset);
  return solid(HalfSpace{{glm::normalize(plane.normal), plane.offset}});
}

FieldPtr slab(double floor, double ceiling) {
  require(std::isfinite(floor), "floor", "finite", floor);
  require(std::isfinite(ceiling) && ceiling > floor, "ceiling", "above the floor", ceiling);
  return solid(Slab{floor, ceiling});
}

FieldPtr cylinder(const Vec3& a, const Vec3& b, double radius) {
  require_finite(a, "a");
  require_finite(b, "b");
  require_positive(radius, "radius");
  require_positive(glm::length(b - a), "length");
  return solid(Cylinder{0.5 * (a + b), glm::normalize(b - a), 0.5 * glm::length(b - a), radius});
}

FieldPtr capsule(const Vec3& a, const Vec3& b, double radius) {
  require_finite(a, "a");
  require_finite(b, "b");
  require_positive(radius, "radius");
  return solid(Capsule{a, b, radius});
}

FieldPtr torus(const Vec3& centre, const Vec3& axis, double major_radius, double minor_radius) {
  require_finite(centre, "centre");
  require_finite(axis, "axis");
  require_positive(glm::length(axis), "axis length");
  require_positive(minor_radius, "minor_radius");
  require(major_radius >= minor_radius && std::isfinite(major_radius), "major_radius", "at least minor_radius",
          major_radius);
  return solid(Torus{centre, glm::normalize(axis), major_radius, minor_radius});
}

}  // namespace outcrop

/// Simple solids: each returns a Field whose value is the exact signed distance unless said otherwise.
#pragma once

#include <span>

#include "outcrop/implicit/field.h"
#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop {

/// @throws ParameterError for a radius ≤ 0 or anything not finite (all functions below alike).
[[nodiscard]] FieldPtr sphere(const Vec3& centre, double radius);
[[nodiscard]] FieldPtr box_solid(const Box& box, double rounding = 0.0);
[[nodiscard]] FieldPtr half_space(const Plane& plane);
[[nodiscard]] FieldPtr slab(double floor, double ceiling);
[[nodiscard]] FieldPtr cylinder(const Vec3& a, const Vec3& b, double radius);
[[nodiscard]] FieldPtr capsule(const Vec3& a, const Vec3& b, double radius);
[[nodiscard]] FieldPtr torus(const Vec3& centre, const Vec3& axis, double major_radius, double minor_radius);

}  // namespace outcrop

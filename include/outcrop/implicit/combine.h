/// Fields made of fields: set operations, smooth ones, transforms, displacement, material labels.
#pragma once

#include <vector>

#include "outcrop/implicit/field.h"

namespace outcrop {

// Labels: a union has those of the field that is smallest (the first of equals); an intersection or difference has
// those of its first field, which the others carve; all other nodes pass them through. All functions throw
// ParameterError for a null field or a parameter outside its bound.

[[nodiscard]] FieldPtr union_of(std::vector<FieldPtr> fields);         ///< min; at least one.
[[nodiscard]] FieldPtr intersection_of(std::vector<FieldPtr> fields);  ///< max; at least one.
[[nodiscard]] FieldPtr difference_of(FieldPtr a, FieldPtr b);          ///< max(a, −b).
/// The cubic blends of radius R ≥ 0: smax(a, b) = max(a, b) + R/6 · max(1 − |a − b|/R, 0)³ and smin(a, b) = −smax(−a,
/// −b).
[[nodiscard]] FieldPtr smooth_union_of(std::vector<FieldPtr> fields, double radius);
[[nodiscard]] FieldPtr smooth_intersection_of(std::vector<FieldPtr> fields, double radius);
[[nodiscard]] FieldPtr smooth_difference_of(FieldPtr a, FieldPtr b, double radius);

/// world = scale · (rotation · local) + translation; values scale along, so distances stay distances.
/// @throws ParameterError unless rotation is orthonormal and scale > 0.
[[nodiscard]] FieldPtr transformed(FieldPtr field, const Mat3& rotation, double scale, const Vec3& translation);

/// f − thickness: grows (> 0) or shrinks the solid.
[[nodiscard]] FieldPtr offset(FieldPtr field, double thickness);
/// |f| − thickness / 2: a shell.
[[nodiscard]] FieldPtr shell(FieldPtr field, double thickness);

/// f + amplitude · n(p / wavelength): gradient noise of 1 to 16 octaves, gain ½, |n| ≤ 1. Method: @cite perlin_2002.
[[nodiscard]] FieldPtr with_noise(FieldPtr field, double amplitude, double wavelength, int octaves, std::uint64_t seed);

/// The gradient warp of Paris et al. 2020 section 4.2, on any field whose gradient is about 1 long: f(p + g D(p)) with
/// the direction g of the unwarped gradient and depth D ≤ amplitude; fades out where the gradient is short.
///
/// g is taken by central differences over 2 amplitudes to each side, so creases of the field round off at the scale of
/// the relief instead of tearing, and a Lipschitz constant is known without one for the gradient. Blocks of rock have
/// their own exact and much faster warp: RoundedPolytope. Cost: 7 evaluations a value, 42 more a gradient.
struct Warp;
[[nodiscard]] FieldPtr warped(FieldPtr field, const Warp& warp);

/// The same field with every label replaced.
[[nodiscard]] FieldPtr labelled(FieldPtr field, Label label);

}  // namespace outcrop

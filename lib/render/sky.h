/// The light of a clear day, and how a picture shows it.
#pragma once

#include "outcrop/core/vec.h"

namespace outcrop::render {

/// Radiance of a white surface that faces the sun; the sky's own is about 1.
[[nodiscard]] Vec3f sun_on_white();

/// Radiance from a direction: the sky above, sunlit ground below the horizon.
/// @param sun  Unit, towards the sun: lights the ground.
[[nodiscard]] Vec3f sky_radiance(const Vec3& direction, const Vec3& sun);

/// What stands behind the rock in a picture: the sky, and haze below the horizon rather than ground.
[[nodiscard]] Vec3f backdrop(const Vec3& direction);

/// Radiance of rock that is seen from rock nearby: what an occluded ambient ray brings back instead of sky.
[[nodiscard]] Vec3f rock_radiance(const Vec3& sun);

/// Scene-referred linear light to display-referred sRGB in 0..1.
[[nodiscard]] Vec3f display_colour(const Vec3f& linear);

/// The i-th of n directions around `normal`, distributed by cosine: a rank-1 lattice shifted by `shift`.
/// @param shift  In [0, 1)².
[[nodiscard]] Vec3 cosine_direction(const Vec3& normal, int i, int n, const Vec2& shift);

}  // namespace outcrop::render

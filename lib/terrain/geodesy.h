/// Degrees on the ground.
#pragma once

#include <cmath>

#include "outcrop/core/vec.h"

namespace outcrop::terrain {

/// Metres a degree of longitude (x) and of latitude (y) at a latitude in degrees: the ellipsoid's radii of curvature.
[[nodiscard]] inline Vec2 metres_per_degree(double latitude_deg) noexcept {
  constexpr double kEquator = 6378137.0;               // WGS 84: semi-major axis, metres.
  constexpr double kEccentricity2 = 0.00669437999014;  // WGS 84: first eccentricity, squared.
  const double s = std::sin(radians(latitude_deg));
  const double w = 1.0 - kEccentricity2 * s * s;
  const double meridian = kEquator * (1.0 - kEccentricity2) / (w * std::sqrt(w));
  const double prime_vertical = kEquator / std::sqrt(w);
  return Vec2(prime_vertical * std::cos(radians(latitude_deg)), meridian) * radians(1.0);
}

}  // namespace outcrop::terrain

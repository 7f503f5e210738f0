/// A small terrain with walls of different steepness between flats, for tests.
#pragma once

#include <algorithm>
#include <cmath>

#include "outcrop/terrain/heightfield.h"

namespace outcrop::test {

/// 64 x 64 m at 1 m: a plateau at about 24 m, a winding wall of some 65 degrees, a bench, a second wall, a floor at about 0.
inline Heightfield terraces(Vec2 origin = Vec2(0.0)) {
  ElevationGrid grid{.width = 64, .height = 64, .origin = origin, .georeferenced = true};
  const auto step = [](double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  };
  for (int row = 0; row < 64; ++row)
    for (int column = 0; column < 64; ++column) {
      const double x = column, y = 63 - row;
      const double across = x + 4.0 * std::sin(0.13 * y) - 32.0;
      const double h = 14.0 * step((across + 14.0) / 8.0) + 10.0 * step((across - 6.0) / 6.0) + 0.05 * y + 0.3 * std::sin(0.4 * x);
      grid.elevations.push_back(static_cast<float>(h));
    }
  return Heightfield(std::move(grid));
}

}  // namespace outcrop::test

/// Small elevation grids for the tests of the terrain stage.
#pragma once

#include <cmath>
#include <limits>

#include "outcrop/core/rng.h"
#include "outcrop/terrain/heightfield.h"

namespace outcrop::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A grid whose sample (x, y) in map coordinates is f(x, y).
template <class F>
[[nodiscard]] ElevationGrid grid_of(int width, int height, const Vec2& cell, const Vec2& origin, F&& f) {
  ElevationGrid grid{.width = width, .height = height, .cell_x = cell.x, .cell_y = cell.y, .origin = origin};
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      grid.elevations.push_back(static_cast<float>(f(origin.x + c * cell.x, origin.y + (height - 1 - r) * cell.y)));
    }
  }
  return grid;
}

/// Rough ground with a wall across it: independent random samples, half of them a step higher.
[[nodiscard]] inline ElevationGrid rough_grid(Seed seed, const Vec2& cell, const Vec2& origin, double step = 40.0) {
  Rng rng(seed, "rough grid");
  return grid_of(17, 13, cell, origin, [&](double x, double y) {
    const double noise = rng.uniform(0.0, 5.0);
    return noise + (x - origin.x + 0.3 * (y - origin.y) > 8.0 * cell.x ? step : 0.0);
  });
}

/// The same with a disc of missing samples in its middle and one at a corner.
[[nodiscard]] inline ElevationGrid holed_grid(Seed seed, const Vec2& cell, const Vec2& origin) {
  ElevationGrid grid = rough_grid(seed, cell, origin);
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      const bool missing = std::hypot(c - 8, r - 6) < 3.2 || (c < 2 && r < 3);
      if (missing) grid.elevations[static_cast<std::size_t>(r) * grid.width + c] = kNan;
    }
  }
  return grid;
}

/// The map position of a sample's centre.
[[nodiscard]] inline Vec2 sample_position(const ElevationGrid& grid, int column, int row) {
  return grid.origin + Vec2(column * grid.cell_x, (grid.height - 1 - row) * grid.cell_y);
}

}  // namespace outcrop::test

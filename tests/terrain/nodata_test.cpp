// Holes and their filling, as Heightfield shows them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "implicit/field_contract.h"
#include "outcrop/core/parallel.h"
#include "outcrop/terrain/heightfield.h"
#include "terrain_samples.h"

namespace outcrop {
namespace {

using test::for_each_seed;
using test::grid_of;
using test::holed_grid;
using test::kNan;
using test::sample_position;

/// Random missing samples: single ones, clumps, whole rows.
ElevationGrid moth_eaten_grid(Seed seed, const Vec2& cell) {
  Rng rng(seed, "moths");
  ElevationGrid grid = test::rough_grid(seed, cell, {0.0, 0.0});
  const double share = rng.uniform(0.05, 0.9);
  for (float& h : grid.elevations) {
    if (rng.uniform() < share) h = kNan;
  }
  grid.elevations[rng.below(grid.elevations.size())] = 7.0f;
  return grid;
}

TEST(Nodata, FillKeepsTheDataAndItsRange) {
  for_each_seed(16, [](Seed seed) {
    const ElevationGrid grid = moth_eaten_grid(seed, {1.0, 2.0});
    const Heightfield heightfield(grid);
    ASSERT_TRUE(heightfield.has_holes());
    Interval range;
    for (const float h : grid.elevations) {
      if (!std::isnan(h)) range.include(h);
    }
    for (std::size_t i = 0; i < grid.elevations.size(); ++i) {
      const float filled = heightfield.grid().elevations[i];
      if (!std::isnan(grid.elevations[i])) {
        ASSERT_EQ(filled, grid.elevations[i]);
      }
      ASSERT_TRUE(range.lo - 1e-4 <= filled && filled <= range.hi + 1e-4) << filled;
    }
  });
}

TEST(Nodata, FillContinuesAPlaneAcrossALargeHole) {
  // A plane is harmonic, so a membrane hung on its rim is the plane; the nearest sample's elevation would be 24 m off.
  const auto plane = [](double x, double y) { return 0.5 * x + 0.25 * y; };
  ElevationGrid grid = grid_of(160, 160, {1.0, 1.0}, {0.0, 0.0}, plane);
  for (int r = 0; r < 160; ++r) {
    for (int c = 0; c < 160; ++c) {
      if (std::hypot(c - 80, r - 80) < 48.0) grid.elevations[static_cast<std::size_t>(r) * 160 + c] = kNan;
    }
  }
  const Heightfield heightfield(grid);
  for (int r = 0; r < 160; ++r) {
    for (int c = 0; c < 160; ++c) {
      const Vec2 p = sample_position(grid, c, r);
      ASSERT_NEAR(heightfield.grid().at(c, r), plane(p.x, p.y), 1.5) << c << ' ' << r;
    }
  }
}

TEST(Nodata, HoleDistanceIsThatOfBruteForce) {
  // Square cells: distance to the nearest sample of the other kind, half a cell less.
  for_each_seed(8, [](Seed seed) {
    const ElevationGrid grid = moth_eaten_grid(seed, {2.0, 2.0});
    const Heightfield heightfield(grid);
    double scale = 0.0;
    for (int r = 0; r < grid.height; ++r) {
      for (int c = 0; c < grid.width; ++c) {
        const bool missing = std::isnan(grid.at(c, r));
        double nearest = std::numeric_limits<double>::infinity();
        for (int y = 0; y < grid.height; ++y) {
          for (int x = 0; x < grid.width; ++x) {
            if (std::isnan(grid.at(x, y)) != missing) nearest = std::min(nearest, 2.0 * std::hypot(x - c, y - r));
          }
        }
        const Vec2 p = sample_position(grid, c, r);
        const double expected = missing ? nearest - 1.0 : 1.0 - nearest;
        const double got = heightfield.hole_distance(p.x, p.y);
        if (scale == 0.0) scale = got / expected;  // One scale for the whole field makes it 1-Lipschitz.
        ASSERT_NEAR(got, scale * expected, 1e-4);
      }
    }
    ASSERT_GE(scale, 1.0 / std::sqrt(2.0) - 1e-4);
    ASSERT_LE(scale, 1.0);
  });
}

TEST(Nodata, HoleDistanceIsLipschitzAndBounded) {
  for (const Vec2 cell : {Vec2(2.0, 2.0), Vec2(1.0, 3.0), Vec2(5.0, 0.5)}) {
    for_each_seed(6, [&](Seed seed) {
      const Heightfield heightfield(moth_eaten_grid(seed, cell));
      Rng rng(seed, "pairs");
      const Vec2 size = heightfield.hi() - heightfield.lo();
      for (int i = 0; i < 400; ++i) {
        const double x = rng.uniform(-1.0, size.x + 1.0), y = rng.uniform(-1.0, size.y + 1.0);
        const double reach = std::pow(10.0, rng.uniform(-3.0, 1.0));
        const double qx = x + rng.uniform(-reach, reach), qy = y + rng.uniform(-reach, reach);
        const double p = heightfield.hole_distance(x, y), q = heightfield.hole_distance(qx, qy);
        ASSERT_LE(std::abs(p - q), std::hypot(qx - x, qy - y) + 1e-9);
        const Interval bound =
            heightfield.hole_bound({std::min(x, qx), std::min(y, qy)}, {std::max(x, qx), std::max(y, qy)});
        ASSERT_TRUE(bound.contains(p) && bound.contains(q) && bound.contains(heightfield.hole_distance(x, qy)));
      }
    });
  }
}

TEST(Nodata, TheRimRunsHalfWayBetweenDataAndHole) {
  for (const Vec2 cell : {Vec2(2.0, 2.0), Vec2(1.0, 3.0)}) {
    ElevationGrid grid = grid_of(10, 10, cell, {0.0, 0.0}, [](double, double) { return 1.0; });
    for (int r = 0; r < 10; ++r) {
      for (int c = 5; c < 10; ++c) grid.elevations[static_cast<std::size_t>(r) * 10 + c] = kNan;
    }
    const Heightfield heightfield(grid);
    EXPECT_NEAR(heightfield.hole_distance(4.5 * cell.x, 3.1), 0.0, 1e-5);
    EXPECT_LT(heightfield.hole_distance(4.4 * cell.x, 3.1), 0.0);
    EXPECT_GT(heightfield.hole_distance(4.6 * cell.x, 3.1), 0.0);
  }
}

TEST(Nodata, AnyNumberOfThreadsGivesTheSameSurface) {
  const ElevationGrid grid = moth_eaten_grid(3, {1.0, 3.0});
  const auto built_with = [&](int threads) {
    const ThreadLimit limit(threads);
    return Heightfield(grid);
  };
  const Heightfield one = built_with(1), four = built_with(4);
  Rng rng(3, "positions");
  for (int i = 0; i < 500; ++i) {
    const double x = rng.uniform(one.lo().x, one.hi().x);
    const double y = rng.uniform(one.lo().y, one.hi().y);
    ASSERT_EQ(one.at(x, y).h, four.at(x, y).h);
    ASSERT_EQ(one.hole_distance(x, y), four.hole_distance(x, y));
    ASSERT_EQ(one.slope_bound({x, y}, {x + 3.0, y + 3.0}), four.slope_bound({x, y}, {x + 3.0, y + 3.0}));
  }
}

TEST(Nodata, WholeGridsHaveNoHoleAnywhere) {
  const Heightfield heightfield(test::rough_grid(1, {1.0, 1.0}, {0.0, 0.0}));
  EXPECT_FALSE(heightfield.has_holes());
  EXPECT_LT(heightfield.hole_distance(3.0, 3.0), -10.0);
  EXPECT_TRUE(heightfield.hole_bound({0.0, 0.0}, {9.0, 9.0}).contains(heightfield.hole_distance(3.0, 3.0)));
}

}  // namespace
}  // namespace outcrop

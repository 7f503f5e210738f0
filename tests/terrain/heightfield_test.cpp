#include "outcrop/terrain/heightfield.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "implicit/field_contract.h"
#include "outcrop/core/error.h"
#include "terrain_samples.h"

namespace outcrop {
namespace {

using test::for_each_seed;
using test::grid_of;
using test::rough_grid;
using test::sample_position;

const Vec2 kCell{2.0, 3.0};
const Vec2 kUtm{4.1e5, 5.2e6};

constexpr Interpolation kBoth[] = {Interpolation::Smooth, Interpolation::Bilinear};

Vec2 random_position(Rng& rng, const Heightfield& heightfield, double margin) {
  const double x = rng.uniform(heightfield.lo().x - margin, heightfield.hi().x + margin);
  const double y = rng.uniform(heightfield.lo().y - margin, heightfield.hi().y + margin);
  return {x, y};
}

TEST(Heightfield, PassesThroughItsSamplesNorthRowFirst) {
  for (const Interpolation interpolation : kBoth) {
    const ElevationGrid grid = rough_grid(1, kCell, kUtm);
    const Heightfield heightfield(grid, interpolation);
    for (int r = 0; r < grid.height; ++r) {
      for (int c = 0; c < grid.width; ++c) {
        const Vec2 p = sample_position(grid, c, r);
        ASSERT_NEAR(heightfield.at(p.x, p.y).h, grid.at(c, r), 1e-6) << "column " << c << ", row " << r;
      }
    }
  }
}

TEST(Heightfield, ReproducesPlanesAndSaddles) {
  const auto saddle = [](double x, double y) { return 3.0 + 0.5 * x - 0.25 * y + 0.125 * x * y; };
  for (const Interpolation interpolation : kBoth) {
    const Heightfield heightfield(grid_of(12, 9, kCell, {-4.0, 8.0}, saddle), interpolation);
    Rng rng(1, "saddle");
    for (int i = 0; i < 200; ++i) {
      const Vec2 p = random_position(rng, heightfield, 0.0);
      const Heightfield::Sample s = heightfield.at(p.x, p.y);
      ASSERT_NEAR(s.h, saddle(p.x, p.y), 1e-5);
      ASSERT_NEAR(s.hx, 0.5 + 0.125 * p.y, 1e-5);
      ASSERT_NEAR(s.hy, -0.25 + 0.125 * p.x, 1e-5);
    }
  }
}

TEST(Heightfield, SmoothHasNoFacets) {
  // Just left and right of every cell border height and gradient agree, and the gradient is that of the height.
  const Heightfield heightfield(rough_grid(2, kCell, {0.0, 0.0}));
  Rng rng(2, "borders");
  for (int i = 0; i < 400; ++i) {
    Vec2 p = random_position(rng, heightfield, -kCell.y);
    const int axis = i % 2;
    p[axis] = std::round(p[axis] / kCell[axis]) * kCell[axis];
    Vec2 step(0.0);
    step[axis] = 1e-7;
    const Heightfield::Sample a = heightfield.at(p.x - step.x, p.y - step.y);
    const Heightfield::Sample b = heightfield.at(p.x + step.x, p.y + step.y);
    ASSERT_NEAR(a.h, b.h, 1e-4);
    ASSERT_NEAR(a.hx, b.hx, 1e-4);
    ASSERT_NEAR(a.hy, b.hy, 1e-4);
    const Vec2 q = random_position(rng, heightfield, -kCell.y);
    const double d = 1e-5;
    const Heightfield::Sample s = heightfield.at(q.x, q.y);
    ASSERT_NEAR(s.hx, (heightfield.at(q.x + d, q.y).h - heightfield.at(q.x - d, q.y).h) / (2 * d), 1e-3);
    ASSERT_NEAR(s.hy, (heightfield.at(q.x, q.y + d).h - heightfield.at(q.x, q.y - d).h) / (2 * d), 1e-3);
  }
}

TEST(Heightfield, SmoothAddsNoExtremaToAStaircase) {
  // A monotone row, walls and ledges in any order: the curve must not ring before or behind a wall.
  for_each_seed(16, [](Seed seed) {
    Rng rng(seed, "staircase");
    std::vector<double> steps;
    double level = 0.0;
    for (int i = 0; i < 24; ++i) {
      const double chance = rng.uniform();
      const double rise = rng.uniform(0.0, 100.0);
      steps.push_back(level += chance < 0.4 ? 0.0 : rise);
    }
    const Heightfield heightfield(
        grid_of(24, 5, {1.0, 1.0}, {0.0, 0.0}, [&](double x, double) { return steps[static_cast<std::size_t>(x)]; }));
    double before = heightfield.at(0.0, 2.0).h;
    for (double x = 0.0; x <= 23.0; x += 0.01) {
      const double h = heightfield.at(x, 2.3).h;
      ASSERT_GE(h, before - 1e-9) << "at x = " << x;
      before = h;
    }
  });
}

TEST(Heightfield, SmoothOvershootsALoneSpikeByNothing) {
  const Heightfield heightfield(
      grid_of(9, 9, {1.0, 1.0}, {0.0, 0.0}, [](double x, double y) { return x == 4.0 && y == 4.0 ? 1000.0 : 0.0; }));
  for (double y = 0.0; y <= 8.0; y += 0.05) {
    for (double x = 0.0; x <= 8.0; x += 0.05) {
      ASSERT_GE(heightfield.at(x, y).h, -1e-9);
      ASSERT_LE(heightfield.at(x, y).h, 1000.0 + 1e-9);
    }
  }
}

TEST(Heightfield, SmoothOvershootsRoughSamplesByLittle) {
  // Per axis at most 4/27 of the smaller step; two axes and the twist stay below a third of the range.
  for_each_seed(16, [](Seed seed) {
    Rng rng(seed, "rough");
    const Heightfield heightfield(
        grid_of(12, 12, {1.0, 1.0}, {0.0, 0.0}, [&](double, double) { return rng.uniform(); }));
    const Interval all = heightfield.height_bound(heightfield.lo(), heightfield.hi());
    for (int i = 0; i < 4000; ++i) {
      const Vec2 p = random_position(rng, heightfield, 0.0);
      ASSERT_TRUE(Interval({-1.0 / 3.0, 4.0 / 3.0}).contains(heightfield.at(p.x, p.y).h));
    }
    ASSERT_GE(all.lo, -1.0);
    ASSERT_LE(all.hi, 2.0);
  });
}

TEST(Heightfield, IsConstantBeyondItsBorder) {
  const Heightfield heightfield(rough_grid(3, kCell, kUtm));
  const double y = heightfield.lo().y + 11.0;
  const Heightfield::Sample border = heightfield.at(heightfield.hi().x, y);
  for (const double beyond : {1e-3, 1.0, 1e4, 1e7, 1e300}) {
    const Heightfield::Sample s = heightfield.at(heightfield.hi().x + beyond, y);
    EXPECT_EQ(s.h, border.h);
    EXPECT_EQ(s.hx, 0.0);
    EXPECT_EQ(s.hy, border.hy);
  }
}

TEST(Heightfield, BoundsContainHeightAndSlopeInAnyRectangle) {
  for (const Interpolation interpolation : kBoth) {
    for_each_seed(8, [&](Seed seed) {
      const Heightfield heightfield(rough_grid(seed, kCell, kUtm), interpolation);
      Rng rng(seed, "rectangles");
      for (int i = 0; i < 200; ++i) {
        const Vec2 corner = random_position(rng, heightfield, 5.0);
        const double size = std::pow(10.0, rng.uniform(-3.0, 1.6));
        const Vec2 lo = corner, hi = corner + Vec2(size, size * rng.uniform());
        const Interval heights = heightfield.height_bound(lo, hi);
        const double slope = heightfield.slope_bound(lo, hi);
        for (int k = 0; k < 30; ++k) {
          const double x = k == 0 ? lo.x : k == 1 ? hi.x : rng.uniform(lo.x, hi.x);
          const double y = k == 0 ? lo.y : k == 1 ? hi.y : rng.uniform(lo.y, hi.y);
          const Heightfield::Sample s = heightfield.at(x, y);
          ASSERT_TRUE(heights.contains(s.h))
              << heights.lo << ' ' << heights.hi << " misses " << s.h << ", size " << size;
          ASSERT_LE(std::hypot(s.hx, s.hy), slope) << "size " << size;
        }
      }
    });
  }
}

TEST(Heightfield, BoundsAreSharp) {
  // Against the range of dense samples: whole grids within the control points' excess, tiny rectangles nearly exact.
  const Heightfield heightfield(rough_grid(5, {30.0, 30.0}, kUtm));
  Rng rng(5, "sharp");
  for (const double size : {0.1, 1.0, 8.0, 200.0}) {
    double excess = 0.0, slope_excess = 0.0;
    for (int i = 0; i < 60; ++i) {
      const Vec2 lo = random_position(rng, heightfield, -100.0), hi = lo + Vec2(size);
      Interval range;
      double steepest = 0.0;
      for (int k = 0; k <= 400; ++k) {
        const Heightfield::Sample s = heightfield.at(lo.x + size * (k % 20) / 19.0, lo.y + size * (k / 20) / 19.0);
        range.include(s.h);
        steepest = std::max(steepest, std::hypot(s.hx, s.hy));
      }
      excess += heightfield.height_bound(lo, hi).width() / (range.width() + 1e-6) / 60.0;
      slope_excess += heightfield.slope_bound(lo, hi) / (steepest + 1e-6) / 60.0;
    }
    EXPECT_LT(excess, size < 1.0 ? 1.3 : 4.0) << "height, rectangles of " << size << " m";
    EXPECT_LT(slope_excess, size < 1.0 ? 1.3 : 4.0) << "slope, rectangles of " << size << " m";
  }
}

TEST(Heightfield, IsFiniteForSamplesOfABillionMetres) {
  for (const Interpolation interpolation : kBoth) {
    Rng rng(1, "huge");
    const Heightfield heightfield(
        grid_of(8, 8, {0.001, 0.001}, {0.0, 0.0}, [&](double, double) { return rng.uniform() < 0.5 ? -1e9 : 1e9; }),
        interpolation);
    EXPECT_TRUE(std::isfinite(heightfield.slope_bound(heightfield.lo(), heightfield.hi())));
    const double nan = std::nan("");
    for (const Vec2 p : {Vec2(0.0031, 0.0042), Vec2(-1e9, 1e9), Vec2(1e300, -1e300), Vec2(nan, nan)}) {
      const Heightfield::Sample s = heightfield.at(p.x, p.y);
      EXPECT_TRUE(std::isfinite(s.h) && std::isfinite(s.hx) && std::isfinite(s.hy)) << p.x << ' ' << p.y;
    }
  }
}

TEST(Heightfield, RefusesBrokenGrids) {
  const ElevationGrid good = rough_grid(1, kCell, kUtm);
  const auto refuses = [&](auto&& spoil) {
    ElevationGrid grid = good;
    spoil(grid);
    EXPECT_THROW(Heightfield{grid}, ParameterError);
  };
  EXPECT_NO_THROW(Heightfield{good});
  refuses([](ElevationGrid& g) { g.width = 1, g.elevations.resize(static_cast<std::size_t>(g.height)); });
  refuses([](ElevationGrid& g) { g.width = g.height = 0, g.elevations.clear(); });
  refuses([](ElevationGrid& g) { g.elevations.pop_back(); });
  refuses([](ElevationGrid& g) { g.cell_x = 0.0; });
  refuses([](ElevationGrid& g) { g.cell_y = -1.0; });
  refuses([](ElevationGrid& g) { g.cell_y = std::nan(""); });
  refuses([](ElevationGrid& g) { g.origin.x = INFINITY; });
  refuses([](ElevationGrid& g) { g.elevations[3] = INFINITY; });
  refuses([](ElevationGrid& g) { std::fill(g.elevations.begin(), g.elevations.end(), test::kNan); });
}

TEST(Heightfield, AnswersABatchAsItAnswersSinglePositions) {
  ElevationGrid grid{.width = 9, .height = 7, .cell_x = 2.0, .cell_y = 3.0};
  Rng rng(1, "batch heights");
  for (int i = 0; i < 63; ++i) grid.elevations.push_back(static_cast<float>(rng.uniform(0.0, 9.0)));
  for (const Interpolation interpolation : {Interpolation::Smooth, Interpolation::Bilinear}) {
    const Heightfield field(grid, interpolation);
    // A lattice of three layers, the second shifted in one place, then positions at random.
    std::vector<double> x, y;
    for (int i = 0; i < 75; ++i) {
      x.push_back(1.0 + i % 5 + (i == 33 ? 0.25 : 0.0));
      y.push_back(2.0 + i / 5 % 5);
    }
    for (int i = 0; i < 75; ++i) {
      x.push_back(rng.uniform(-5.0, 25.0));
      y.push_back(rng.uniform(-5.0, 25.0));
    }
    std::vector<Heightfield::Sample> samples(x.size());
    std::vector<double> heights(x.size());
    field.at(x, y, samples);
    field.heights(x, y, heights);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Heightfield::Sample alone = field.at(x[i], y[i]);
      ASSERT_EQ(samples[i].h, alone.h);
      ASSERT_EQ(samples[i].hx, alone.hx);
      ASSERT_EQ(samples[i].hy, alone.hy);
      ASSERT_EQ(heights[i], alone.h);
    }
  }
}

}  // namespace
}  // namespace outcrop

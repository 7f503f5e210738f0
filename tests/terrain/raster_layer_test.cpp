#include "outcrop/terrain/raster_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

constexpr int kWidth = 38, kHeight = 27;
const Vec2 kLo(-7.0, 1e6);
constexpr double kSpacing = 0.3;

std::vector<float> random_nodes(Seed seed) {
  Rng rng(seed, "raster layer test");
  std::vector<float> nodes(kWidth * kHeight);
  // Mostly 0, as the layers that it is made for.
  for (float& n : nodes) n = rng.uniform() < 0.6 ? 0.0f : static_cast<float>(rng.uniform(-2.0, 5.0));
  return nodes;
}

TEST(RasterLayer, EqualsABilinearHeightfield) {
  const std::vector<float> nodes = random_nodes(1);
  ElevationGrid grid{.width = kWidth, .height = kHeight, .cell_x = kSpacing, .cell_y = kSpacing, .origin = kLo};
  for (int row = kHeight - 1; row >= 0; --row)
    grid.elevations.insert(grid.elevations.end(), nodes.begin() + row * kWidth, nodes.begin() + (row + 1) * kWidth);
  const Heightfield heightfield(std::move(grid), Interpolation::Bilinear);
  const RasterLayer layer(kWidth, kHeight, kLo, kSpacing, nodes);
  EXPECT_EQ(layer.lo(), heightfield.lo());
  Rng rng(2, "raster layer test");
  for (int i = 0; i < 5000; ++i) {
    const double x = kLo.x + rng.uniform(-2.0, 13.0), y = kLo.y + rng.uniform(-2.0, 10.0);
    const Heightfield::Sample a = layer.at(x, y), b = heightfield.at(x, y);
    ASSERT_NEAR(a.h, b.h, 1e-7);
    ASSERT_NEAR(a.hx, b.hx, 1e-5);
    ASSERT_NEAR(a.hy, b.hy, 1e-5);
  }
}

TEST(RasterLayer, BoundsHoldInRandomRectangles) {
  for (Seed seed = 1; seed <= 8; ++seed) {
    const RasterLayer layer(kWidth, kHeight, kLo, kSpacing, random_nodes(seed));
    Rng rng(seed, "rectangles");
    for (int i = 0; i < 400; ++i) {
      const Vec2 lo = kLo + Vec2(rng.uniform(-1.0, 12.0), rng.uniform(-1.0, 9.0));
      const Vec2 hi = lo + std::pow(rng.uniform(), 3.0) * 6.0 * Vec2(rng.uniform(), rng.uniform());
      const Interval bound = layer.bound(lo, hi);
      const double slope = layer.slope_bound(lo, hi);
      for (int k = 0; k < 30; ++k) {
        // Corners and sides too, where bounds are touched.
        const Vec2 p(k % 3 == 0 ? lo.x : rng.uniform(lo.x, hi.x), k % 5 == 0 ? hi.y : rng.uniform(lo.y, hi.y));
        const Heightfield::Sample s = layer.at(p.x, p.y);
        ASSERT_LE(bound.lo, s.h);
        ASSERT_GE(bound.hi, s.h);
        ASSERT_GE(slope, std::hypot(s.hx, s.hy) - 1e-12);
      }
    }
  }
}

TEST(RasterLayer, OfZerosIsExactlyZero) {
  const RasterLayer layer(kWidth, kHeight, kLo, kSpacing, std::vector<float>(kWidth * kHeight));
  const Interval bound = layer.bound(kLo, kLo + 3.0);
  EXPECT_EQ(bound.lo, 0.0);
  EXPECT_EQ(bound.hi, 0.0);
  EXPECT_EQ(RasterLayer().at(3.0, 4.0).h, 0.0);
}

}  // namespace
}  // namespace outcrop

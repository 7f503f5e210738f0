#include "outcrop/terrain/material_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "outcrop/core/error.h"
#include "outcrop/core/rng.h"
#include "outcrop/terrain/strata.h"

namespace outcrop {
namespace {

Heightfield flat(int width, int height, double cell = 1.0) {
  ElevationGrid grid{.width = width, .height = height, .cell_x = cell, .cell_y = cell, .origin = Vec2(1000.0, 2000.0)};
  grid.elevations.assign(static_cast<std::size_t>(width) * height, 5.0f);
  return Heightfield(std::move(grid));
}

Image image(int width, int height) {
  Image result{.width = width, .height = height, .channels = 1, .channel_names = {"Y"}, .full_scale = 255.0};
  result.pixels.assign(static_cast<std::size_t>(width) * height, 0.0f);
  return result;
}

TEST(MapImage, FitsTheSamplesOrTheProportionsOfATerrain) {
  const Heightfield heightfield = flat(41, 21);
  EXPECT_FALSE(MapImage::misfit(image(41, 21), heightfield));
  EXPECT_FALSE(MapImage::misfit(image(400, 200), heightfield));
  EXPECT_FALSE(MapImage::misfit(image(401, 200), heightfield));
  ASSERT_TRUE(MapImage::misfit(image(400, 210), heightfield));
  EXPECT_NE(MapImage::misfit(image(400, 210), heightfield)->find("41 x 21"), std::string::npos);
  EXPECT_THROW(MapImage(image(21, 41), heightfield), ParameterError);
}

TEST(MapImage, RowZeroIsTheNorthEdge) {
  Image mask = image(41, 21);
  mask.at(0, 0) = 255.0f;
  mask.at(40, 20) = 51.0f;
  const MapImage map(mask, flat(41, 21, 2.0));
  EXPECT_DOUBLE_EQ(map.brightness(1000.0, 2040.0), 1.0);
  EXPECT_DOUBLE_EQ(map.brightness(1001.0, 2040.0), 0.5) << "half-way to the next sample";
  EXPECT_DOUBLE_EQ(map.brightness(1080.0, 2000.0), 0.2);
  EXPECT_DOUBLE_EQ(map.brightness(9999.0, 0.0), 0.2) << "the border goes on";
}

TEST(MaterialMap, NamesTheMaterialOfThePixelAndItsDistance) {
  Image pixels = image(40, 20);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 40; ++x) pixels.at(x, y) = x < 10 ? 10.0f : x < 30 ? 20.0f : 0.0f;
  const Heightfield heightfield = flat(41, 21);
  const MaterialMap map(MapImage(pixels, heightfield), heightfield, {{{10.0f}, 3}, {{20.0f}, 4}});
  EXPECT_EQ(map.at(1004.0, 2010.0), Label{3});
  EXPECT_EQ(map.at(1020.0, 2010.0), Label{4});
  EXPECT_EQ(map.at(1035.0, 2010.0), std::nullopt);
  EXPECT_NEAR(map.area(Label{4})->at(1015.0, 2010.0).h, -5.0, 0.5);
  EXPECT_NEAR(map.area(std::nullopt)->at(1020.0, 2010.0).h, 10.0, 0.5);
  EXPECT_EQ(map.area(Label{9}), nullptr);
}

TEST(MaterialMap, OverridesLayersAndBoundsBodies) {
  Rng rng(1, "map");
  Image pixels = image(30, 30);
  for (float& pixel : pixels.pixels) pixel = static_cast<float>(rng.below(3));
  const Heightfield heightfield = flat(61, 61);
  Strata strata;
  strata.layers = {{.material = 0, .top = 0.0}, {.material = 1}};
  strata.map = MaterialMap(MapImage(pixels, heightfield), heightfield, {{{1.0f}, 0}, {{2.0f}, 2}});
  std::vector<FieldPtr> bodies;
  for (const Label material : {Label{0}, Label{1}, Label{2}})
    bodies.push_back(stratum_body(strata, material, strata.limbs()[0], 1e3, 1.0));
  int named = 0;
  for (int i = 0; i < 5000; ++i) {
    const double x = rng.uniform(1000.0, 1060.0), y = rng.uniform(2000.0, 2060.0), z = rng.uniform(-5.0, 5.0);
    const Vec3 p(x, y, z);
    int inside = 0;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      if (bodies[k]->value(p) >= 0.0) continue;
      ++inside;
      ASSERT_EQ(strata.material(p), k);
    }
    ASSERT_LE(inside, 1);
    named += inside;
  }
  EXPECT_GT(named, 4500);
}

}  // namespace
}  // namespace outcrop

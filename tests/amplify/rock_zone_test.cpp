#include "rock_zone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "implicit/field_contract.h"
#include "outcrop/core/rng.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/terrain/terrain_field.h"
#include "terraces.h"

namespace outcrop {
namespace {

const double kSlope = radians(40.0);

RockZone zone_of(const Heightfield& heightfield) {
  return make_rock_zone(heightfield,
                        {.lo = heightfield.lo(), .hi = heightfield.hi(), .slope = kSlope, .reach = 3.0, .spacing = 0.5});
}

TEST(RockZone, IsExactlyNothingOverGroundThatIsNotSteep) {
  const Heightfield heightfield = test::terraces();
  const RockZone zone = zone_of(heightfield);
  ASSERT_FALSE(zone.empty);
  Rng rng(1, "rock zone test");
  int steep = 0;
  for (int i = 0; i < 50'000; ++i) {
    const double x = rng.uniform(heightfield.lo().x, heightfield.hi().x);
    const double y = rng.uniform(heightfield.lo().y, heightfield.hi().y);
    const Heightfield::Sample s = heightfield.at(x, y);
    const bool open = zone.recess.at(x, y).h != 0.0 || zone.advance.at(x, y).h != 0.0;
    if (std::hypot(s.hx, s.hy) < std::tan(kSlope))
      ASSERT_FALSE(open) << x << ' ' << y;
    else
      steep += open;
  }
  EXPECT_GT(steep, 1000);
}

TEST(RockZone, DoesNotAdvanceAboveThePlateau) {
  const Heightfield heightfield = test::terraces();
  const RockZone zone = zone_of(heightfield);
  const Interval heights = heightfield.height_bound(heightfield.lo(), heightfield.hi());
  for (double x = 0.0; x < 63.0; x += 0.37)
    for (double y = 0.0; y < 63.0; y += 0.41) {
      const double h = heightfield.at(x, y).h;
      ASSERT_GE(zone.recess.at(x, y).h, 0.0);
      ASSERT_GE(zone.advance.at(x, y).h, 0.0);
      // The envelope is sampled: between nodes it may miss the level by what the ground does within a node's width.
      ASSERT_LE(h + zone.advance.at(x, y).h, heights.hi + 1.5);
    }
}

// Its rasters end where nothing steep is near.
TEST(RockZone, IsTheSameHoweverMuchGentleGroundLiesAround) {
  ElevationGrid grid{.width = 256, .height = 256};
  for (int i = 0; i < 256 * 256; ++i) {
    const double r = std::hypot(i % 256 - 128, i / 256 - 128);
    grid.elevations.push_back(static_cast<float>(10.0 * std::clamp((16.0 - r) / 6.0, 0.0, 1.0)));
  }
  const Heightfield heightfield(std::move(grid));
  const auto zone = [&](const Vec2& lo, const Vec2& hi) {
    return make_rock_zone(heightfield, {.lo = lo, .hi = hi, .slope = kSlope, .reach = 3.0, .spacing = 0.5});
  };
  const RockZone wide = zone(heightfield.lo(), heightfield.hi()), close = zone(Vec2(96.0), Vec2(160.0));
  ASSERT_FALSE(wide.empty);
  EXPECT_GT(wide.recess.lo().x, 50.0);
  Rng rng(1, "rock zone test");
  for (int i = 0; i < 20'000; ++i) {
    const double x = rng.uniform(0.0, 255.0);
    const double y = rng.uniform(0.0, 255.0);
    for (const auto layer : {&RockZone::recess, &RockZone::advance, &RockZone::nearby})
      ASSERT_NEAR((wide.*layer).at(x, y).h, (close.*layer).at(x, y).h, 1e-5) << x << ' ' << y;
  }
}

TEST(RockZone, IsExactlyNothingWhereItsWeightIsNothing) {
  const Heightfield heightfield = test::terraces();
  const auto weight = [](const Vec3& p) { return std::clamp((p.y - 20.0) / 15.0, 0.0, 1.0) * (p.z < 21.0); };
  const RockZone whole = zone_of(heightfield);
  const RockZone zone = make_rock_zone(heightfield, {.lo = heightfield.lo(),
                                                     .hi = heightfield.hi(),
                                                     .slope = kSlope,
                                                     .reach = 3.0,
                                                     .spacing = 0.5,
                                                     .weight_at = weight});
  Rng rng(2, "rock zone test");
  int thin = 0;
  for (int i = 0; i < 50'000; ++i) {
    const double x = rng.uniform(heightfield.lo().x, heightfield.hi().x);
    const double y = rng.uniform(heightfield.lo().y, heightfield.hi().y);
    const double recess = zone.recess.at(x, y).h;
    if (weight({x, y, heightfield.at(x, y).h}) == 0.0) {
      ASSERT_EQ(recess, 0.0) << x << ' ' << y;
      ASSERT_EQ(zone.advance.at(x, y).h, 0.0);
    }
    ASSERT_LE(recess, whole.recess.at(x, y).h + 1e-6);
    if (y < 35.0 && recess > 0.0) ++thin;
  }
  EXPECT_GT(thin, 300);
}

TEST(RockZone, ReachesIntoRockOfNoWeightAsFarAsBlocksDo) {
  const Heightfield heightfield = test::terraces();
  const auto weight = [](const Vec3& p) { return p.y > 20.0 && (p.y < 30.0 || p.y > 31.0) ? 1.0 : 0.0; };
  const RockZone zone = make_rock_zone(heightfield, {.lo = heightfield.lo(),
                                                     .hi = heightfield.hi(),
                                                     .slope = kSlope,
                                                     .reach = 3.0,
                                                     .spacing = 0.5,
                                                     .rock_weight_at = weight});
  int within = 0;
  for (double x = 1.0; x < 63.0; x += 0.3) {
    within += zone.recess.at(x, 30.5).h > 0.0;
    ASSERT_EQ(zone.recess.at(x, 17.0).h, 0.0) << "more than half a reach from any rock";
  }
  EXPECT_GT(within, 10) << "a thin bed between two that have rock";
}

TEST(RockZone, WithdrawsTheGroundBySquareOfALevelWeight) {
  const Heightfield heightfield = test::terraces();
  const RockZone whole = zone_of(heightfield);
  const RockZone half = make_rock_zone(heightfield, {.lo = heightfield.lo(),
                                                     .hi = heightfield.hi(),
                                                     .slope = kSlope,
                                                     .reach = 3.0,
                                                     .spacing = 0.5,
                                                     .weight_at = [](const Vec3&) { return 0.5; }});
  for (double x = 1.0; x < 63.0; x += 0.7)
    for (double y = 1.0; y < 63.0; y += 0.9) ASSERT_NEAR(half.recess.at(x, y).h, 0.25 * whole.recess.at(x, y).h, 1e-4);
}

TEST(RockZone, BlocksThinOutTowardsTheRim) {
  const Heightfield heightfield = test::terraces();
  const RockZone zone = make_rock_zone(
      heightfield,
      {.lo = heightfield.lo(), .hi = heightfield.hi(), .slope = kSlope, .reach = 3.0, .spacing = 0.5, .rim = 1.0});
  ASSERT_TRUE(zone.weighted);
  int part = 0, whole = 0;
  for (double x = 1.0; x < 63.0; x += 0.7)
    for (double y = 1.0; y < 63.0; y += 0.9) {
      const double weight = zone.rim.at(x, y).h;
      part += weight > 0.05 && weight < 0.95;
      whole += weight >= 0.95;
      // Next to any place within reach there is ground of the zone.
      const Vec2 ground = zone.ground.at({x, y});
      ASSERT_TRUE(zone.recess.at(x, y).h == 0.0 || glm::length(ground - Vec2(x, y)) < 1.0);
    }
  EXPECT_GT(part, 200);
  EXPECT_GT(whole, 100);
}

TEST(RockZone, WithoutSteepGroundIsEmpty) {
  ElevationGrid grid{.width = 8, .height = 8};
  for (int i = 0; i < 64; ++i) grid.elevations.push_back(0.2f * static_cast<float>(i % 8));
  EXPECT_TRUE(zone_of(Heightfield(grid)).empty);
}

TEST(RockOnTerrain, PassesTheFieldContract) {
  const Heightfield heightfield = test::terraces();
  const auto terrain = std::make_shared<TerrainField>(heightfield);
  const FieldPtr rock = sphere({30.0, 30.0, 10.0}, 9.0);
  const FieldPtr field = rock_on_terrain(terrain, zone_of(heightfield), rock, terrain, 1);
  test::check_field_contract(*field, {Vec3(1.0, 1.0, -5.0), Vec3(62.0, 62.0, 30.0)});
  test::check_field_contract(*displaced_terrain(terrain, zone_of(heightfield).recess, 0.7),
                             {Vec3(1.0, 1.0, -5.0), Vec3(62.0, 62.0, 30.0)});
}

}  // namespace
}  // namespace outcrop

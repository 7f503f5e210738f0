#include "outcrop/terrain/strata.h"

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/field_contract.h"
#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

using test::for_each_seed;

Strata random_strata(Seed seed) {
  Rng rng(seed, "strata");
  Strata strata;
  strata.dip = rng.uniform(0.0, radians(80.0));
  strata.dip_direction = rng.uniform(0.0, 2.0 * kPi);
  strata.reference = {rng.uniform(-1e3, 1e3), 5e6};
  strata.undulation_wavelength = rng.uniform(10.0, 200.0);
  strata.seed = seed;
  return strata;
}

TEST(Strata, BedsDipTowardsTheirDipDirection) {
  // Ten metres due east of the reference, a bed that dips 30° to the east lies 10 tan 30° lower.
  Strata strata;
  strata.dip = radians(30.0);
  strata.dip_direction = radians(90.0);
  strata.reference = {100.0, 200.0};
  EXPECT_NEAR(strata.stratigraphic_height({110.0, 200.0, 50.0 - 10.0 * std::tan(strata.dip)}), 50.0, 1e-9);
  EXPECT_NEAR(strata.stratigraphic_height({100.0, 777.0, 50.0}), 50.0, 1e-9);
}

TEST(Strata, HeightIsConstantAlongTheBedding) {
  for_each_seed(16, [](Seed seed) {
    const Strata strata = random_strata(seed);
    const Mat3 turn = strata.world_from_bedding();
    const Vec3 p(strata.reference + Vec2(13.0, -4.0), 321.0);
    const double height = strata.stratigraphic_height(p);
    ASSERT_NEAR(strata.stratigraphic_height(p + turn * Vec3(50.0, 0.0, 0.0)), height, 1e-6);
    ASSERT_NEAR(strata.stratigraphic_height(p + turn * Vec3(0.0, 50.0, 0.0)), height, 1e-6);
    // Across the bedding by t metres the height grows by t / cos(dip): true thickness against vertical thickness.
    ASSERT_NEAR(strata.stratigraphic_height(p + turn * Vec3(0.0, 0.0, 7.0)), height + 7.0 / std::cos(strata.dip), 1e-6);
  });
}

TEST(Strata, WorldFromBeddingIsARotationAboutTheStrike) {
  for_each_seed(16, [](Seed seed) {
    const Strata strata = random_strata(seed);
    const Mat3 turn = strata.world_from_bedding();
    const Mat3 product = glm::transpose(turn) * turn;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) ASSERT_NEAR(product[i][j], i == j ? 1.0 : 0.0, 1e-12);
    }
    ASSERT_NEAR(glm::determinant(turn), 1.0, 1e-12);
    const Vec3 strike(-std::cos(strata.dip_direction), std::sin(strata.dip_direction), 0.0);
    ASSERT_LT(glm::length(turn * strike - strike), 1e-12);
  });
}

TEST(Strata, UndulationIsBoundedSmoothAndZeroAtTheReference) {
  for_each_seed(8, [](Seed seed) {
    Strata flat = random_strata(seed);
    Strata wavy = flat;
    wavy.undulation = 3.0;
    const Vec3 reference(wavy.reference, 10.0);
    ASSERT_NEAR(wavy.stratigraphic_height(reference), 10.0, 1e-9);
    Rng rng(seed, "positions");
    double largest = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const double dx = rng.uniform(-5e3, 5e3);
      const double dy = rng.uniform(-5e3, 5e3);
      const Vec3 p = reference + Vec3(dx, dy, 0.0);
      const auto bend = [&](const Vec3& q) { return wavy.stratigraphic_height(q) - flat.stratigraphic_height(q); };
      largest = std::max(largest, std::abs(bend(p)));
      // C¹: the two one-sided slopes agree, at lattice lines too (every other position is moved onto one).
      Vec3 q = p;
      if (i % 2) q.x = wavy.reference.x + std::round(dx / wavy.undulation_wavelength) * wavy.undulation_wavelength;
      const double d = 1e-4 * wavy.undulation_wavelength;
      const double right = (bend(q + Vec3(d, 0, 0)) - bend(q)) / d, left = (bend(q) - bend(q - Vec3(d, 0, 0))) / d;
      ASSERT_NEAR(right, left, 0.01 * 3.0 / wavy.undulation_wavelength * 20.0);
    }
    ASSERT_LE(largest, 3.0);
    ASSERT_GE(largest, 1.0);
  });
}

TEST(Strata, SeedsBendBedsDifferently) {
  Strata a, b;
  a.undulation = b.undulation = 5.0;
  b.seed = 2;
  EXPECT_NE(a.stratigraphic_height({33.0, 44.0, 0.0}), b.stratigraphic_height({33.0, 44.0, 0.0}));
}

TEST(Strata, MaterialIsTheFirstLayerWhoseTopIsAbove) {
  Strata strata;
  EXPECT_EQ(strata.material({0, 0, 5}), 0);
  strata.layers = {{.material = 7, .top = 10.0}, {.material = 8, .top = 20.0}, {.material = 9, .top = 0.0}};
  EXPECT_EQ(strata.material({0, 0, -1e6}), 7);
  EXPECT_EQ(strata.material({0, 0, 9.99}), 7);
  EXPECT_EQ(strata.material({0, 0, 10.0}), 8);
  EXPECT_EQ(strata.material({0, 0, 19.99}), 8);
  EXPECT_EQ(strata.material({0, 0, 20.0}), 9);
  EXPECT_EQ(strata.material({0, 0, 1e6}), 9);
}

TEST(Strata, MaterialFollowsTheUndulatingHeight) {
  for_each_seed(8, [](Seed seed) {
    Strata strata = random_strata(seed);
    strata.undulation = 4.0;
    for (int i = 0; i < 6; ++i) strata.layers.push_back({.material = static_cast<Label>(i + 1), .top = 3.0 * i});
    Rng rng(seed, "material");
    for (int i = 0; i < 5000; ++i) {
      const double x = rng.uniform(-20.0, 20.0), y = rng.uniform(-20.0, 20.0), z = rng.uniform(-40.0, 60.0);
      const Vec3 p(Vec2(x, y) + strata.reference, z);
      const double height = strata.stratigraphic_height(p);
      const int below = std::clamp(static_cast<int>(std::floor(height / 3.0)) + 1, 0, 5);
      ASSERT_EQ(strata.material(p), below + 1) << height;
    }
  });
}

}  // namespace
}  // namespace outcrop

#include "outcrop/terrain/strata.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

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

TEST(Strata, SequencesRepeatUpwardsAndDownwards) {
  Strata strata;
  strata.base = 10.0;
  strata.layers = {{.material = 1, .top = 12.0}, {.material = 2, .top = 15.0}};
  for (int pile = -7; pile <= 7; ++pile) {
    const double bottom = 10.0 + 5.0 * pile;
    EXPECT_EQ(strata.material({3, 4, bottom + 0.01}), 1) << pile;
    EXPECT_EQ(strata.material({3, 4, bottom + 1.99}), 1) << pile;
    EXPECT_EQ(strata.material({3, 4, bottom + 2.01}), 2) << pile;
    EXPECT_EQ(strata.material({3, 4, bottom + 4.99}), 2) << pile;
  }
}

TEST(Strata, FoldsAreCylindersAlongTheirAxis) {
  Strata strata;
  strata.reference = {100.0, 200.0};
  strata.fold = {.amplitude = 6.0, .wavelength = 80.0, .axis = radians(90.0)};  // Along x: across it to the south.
  EXPECT_NEAR(strata.stratigraphic_height({777.0, 200.0, 5.0}), 5.0, 1e-9) << "the reference lies on a flank";
  EXPECT_NEAR(strata.stratigraphic_height({777.0, 180.0, 5.0 + 6.0}), 5.0, 1e-9) << "a quarter on, a crest";
  EXPECT_NEAR(strata.stratigraphic_height({-33.0, 220.0, 5.0 - 6.0}), 5.0, 1e-9) << "on the other side, a trough";
}

TEST(Strata, LimbsLieAlongTheFoldedBeddingAndCoverEachWavelengthOnce) {
  for_each_seed(8, [](Seed seed) {
    Strata strata = random_strata(seed);
    strata.dip = radians(5.0) * static_cast<double>(seed % 4);
    strata.fold = {.amplitude = 10.0, .wavelength = 90.0, .axis = 0.3 * static_cast<double>(seed)};
    const std::vector<Strata::Limb> limbs = strata.limbs();
    ASSERT_GE(limbs.size(), 5u);
    Rng rng(seed, "limbs");
    for (int i = 0; i < 200; ++i) {
      const double x = rng.uniform(-200.0, 200.0), y = rng.uniform(-200.0, 200.0);
      const Vec3 p(strata.reference + Vec2(x, y), 7.0);
      int inside = 0;
      for (const Strata::Limb& limb : limbs) {
        const FieldPtr body = stratum_body(strata, 0, limb, 1e3, 1.0);
        if (body->value(p) > 0.0) continue;
        ++inside;
        const auto slope = [&](const Vec3& step) {
          return 0.5e3 * (strata.stratigraphic_height(p + 1e-3 * step) - strata.stratigraphic_height(p - 1e-3 * step));
        };
        const Vec3 normal = glm::normalize(Vec3(slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})));
        ASSERT_LT(std::acos(std::min(1.0, glm::dot(normal, limb.world_from_bedding[2]))), radians(8.0));
      }
      ASSERT_EQ(inside, 1);
    }
  });
}

TEST(Strata, TheHangingWallOfANormalFaultLiesSlipFurtherDownTheDip) {
  Strata strata;
  strata.faults = {{.point = {50.0, 0.0, 10.0}, .dip = radians(60.0), .dip_direction = radians(90.0), .slip = 4.0}};
  const double throw_of_slip = 4.0 * std::sin(radians(60.0));
  EXPECT_NEAR(strata.stratigraphic_height({40.0, 5.0, 10.0}), 10.0, 1e-9) << "the footwall, west of it, stays";
  EXPECT_NEAR(strata.stratigraphic_height({60.0, 5.0, 10.0}), 10.0 + throw_of_slip, 1e-9);
  strata.faults[0].extent = 20.0;
  EXPECT_NEAR(strata.stratigraphic_height({50.01, 0.0, 10.0}), 10.0 + throw_of_slip, 1e-3);
  EXPECT_NEAR(strata.stratigraphic_height({75.0, 0.0, 10.0}), 10.0, 1e-9) << "beyond its extent";
}

TEST(Strata, YoungerFaultsMoveOlderOnes) {
  // The old vertical fault at x = 0 drops the east by 3 m. The young one, of 45° to the east, moves what lies above it
  // by (5, 0, −5), the old fault included.
  Strata strata;
  strata.faults = {{.point = {0, 0, 0}, .dip = radians(90.0), .dip_direction = radians(90.0), .slip = 3.0},
                   {.point = {0, 0, 0}, .dip = radians(45.0), .dip_direction = radians(90.0), .slip = std::sqrt(50.0)}};
  const auto drop = [&](double x, double z) { return strata.stratigraphic_height({x, 0, z}) - z; };
  EXPECT_NEAR(drop(-1.0, -5.0), 0.0, 1e-9) << "footwall of both";
  EXPECT_NEAR(drop(1.0, -5.0), 3.0, 1e-9) << "hanging wall of the old one";
  EXPECT_NEAR(drop(4.0, 5.0), 5.0, 1e-9) << "above the young one, west of where the old one is now";
  EXPECT_NEAR(drop(6.0, 5.0), 8.0, 1e-9);
}

/// Materials in any mixture of dip, undulation, folds, faults and repetition.
Strata hard_strata(Seed seed) {
  Rng rng(seed, "hard strata");
  Strata strata;
  strata.dip = rng.uniform(0.0, radians(50.0));
  strata.dip_direction = rng.uniform(0.0, 2.0 * kPi);
  strata.reference = {rng.uniform(-20.0, 20.0), rng.uniform(-20.0, 20.0)};
  strata.seed = seed;
  if (seed % 2) strata.undulation = 2.0, strata.undulation_wavelength = 60.0;
  if (seed % 3) strata.fold = {.amplitude = 4.0, .wavelength = 70.0, .axis = rng.uniform(0.0, kPi)};
  for (std::uint64_t i = 0; i < seed % 4; ++i) {
    const Vec3 point = test::random_point(rng, {Vec3(-15.0), Vec3(15.0)});
    const double extent = i == 1 ? 25.0 : std::numeric_limits<double>::infinity();
    const double dip = rng.uniform(radians(30.0), radians(90.0));
    const double direction = rng.uniform(0.0, 2.0 * kPi);
    strata.faults.push_back({point, dip, direction, rng.uniform(-6.0, 6.0), extent});
  }
  if (seed % 5 < 3) strata.base = -4.0;
  strata.layers = {{.material = 0, .top = -1.0},
                   {.material = 1, .top = 3.0},
                   {.material = 0, .top = 4.0},
                   {.material = 2, .top = 9.0}};
  return strata;
}

TEST(StratumBody, IsNegativeWhereItsMaterialStandsAndNoTwoMeet) {
  for_each_seed(12, [](Seed seed) {
    const Strata strata = hard_strata(seed);
    std::vector<FieldPtr> bodies;
    std::vector<Label> materials;
    for (const Strata::Limb& limb : strata.limbs())
      for (const Label material : {Label{0}, Label{1}, Label{2}}) {
        bodies.push_back(stratum_body(strata, material, limb, 4.0, 0.8));
        materials.push_back(material);
      }
    Rng rng(seed, "points");
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = test::random_point(rng, {Vec3(-30.0), Vec3(30.0)});
      int inside = 0, near = 0;
      for (std::size_t k = 0; k < bodies.size(); ++k) {
        const double value = bodies[k]->value(p);
        ASSERT_LE(value, 0.8);
        near += std::abs(value) < 1e-9;
        if (value >= 0.0) continue;
        ++inside;
        ASSERT_EQ(strata.material(p), materials[k]);
      }
      ASSERT_TRUE(inside == 1 || near > 0) << inside;
    }
  });
}

TEST(StratumBody, PassesTheFieldContract) {
  for (const Seed seed : {1, 2, 3, 5, 7, 11}) {
    const Strata strata = hard_strata(seed);
    test::check_field_contract(*stratum_body(strata, 1, strata.limbs().back(), 4.0, 0.8), {Vec3(-25.0), Vec3(25.0)}, 3);
  }
}

TEST(StratumBody, IsTheDistanceToPlanarBeds) {
  Strata strata;
  strata.dip = radians(40.0);
  strata.dip_direction = radians(200.0);
  strata.layers = {{.material = 0, .top = 0.0}, {.material = 1, .top = 6.0}, {.material = 2}};
  const FieldPtr body = stratum_body(strata, 1, strata.limbs()[0], 1e3, 100.0);
  const Vec3 up = strata.world_from_bedding()[2];
  const double thickness = 6.0 * std::cos(strata.dip);
  for (const double t : {-3.0, -0.5, 0.0, 1.0, 2.0, 7.0})
    EXPECT_NEAR(body->value(t * up), std::max(-t, t - thickness), 1e-9) << t;
}

TEST(StratumBody, IsNullWhereOneRockIsEverywhere) {
  const Strata strata;
  EXPECT_EQ(stratum_body(strata, 0, strata.limbs()[0], 1e3, 1.0), nullptr);
}

}  // namespace
}  // namespace outcrop

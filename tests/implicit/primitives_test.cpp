#include "outcrop/implicit/primitives.h"

#include <gtest/gtest.h>

#include <limits>

#include "implicit/field_contract.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

const Box kRegion{Vec3(-3.0), Vec3(3.5)};

struct Named {
  const char* name;
  FieldPtr field;
};

[[nodiscard]] std::vector<Named> bounded_solids() {
  return {{"sphere", sphere({0.5, 0, 0}, 1.5)},
          {"box", box_solid({{-1, -2, -0.5}, {2, 1, 1}})},
          {"rounded box", box_solid({{-1, -2, -0.5}, {2, 1, 1}}, 0.4)},
          {"cylinder", cylinder({-1, 0, -1}, {1, 0.5, 2}, 0.8)},
          {"capsule", capsule({-1, 0, -1}, {1, 0.5, 2}, 0.8)},
          {"torus", torus({0, 0, 0.5}, {1, 1, 3}, 1.5, 0.5)}};
}

TEST(Primitives, PassTheContract) {
  for (const Named& solid : bounded_solids()) {
    SCOPED_TRACE(solid.name);
    test::check_field_contract(*solid.field, kRegion, 3);
  }
  test::check_field_contract(*half_space({glm::normalize(Vec3(1, -2, 0.5)), 0.3}), kRegion, 3);
  test::check_field_contract(*slab(-0.5, 1.25), kRegion, 3);
}

TEST(Primitives, AreExactDistancesSoThatAStepAlongTheGradientLandsOnTheSurface) {
  std::vector<Named> solids = bounded_solids();
  solids.push_back({"half-space", half_space({glm::normalize(Vec3(1, -2, 0.5)), 0.3})});
  solids.push_back({"slab", slab(-0.5, 1.25)});
  for (const Named& solid : solids) {
    SCOPED_TRACE(solid.name);
    test::for_each_seed(200, [&](Seed seed) {
      Rng rng(seed, "points");
      const Vec3 p = test::random_point(rng, kRegion);
      const double value = solid.field->value(p);
      if (value < 0.0)
        return;  // Inside, the step can cross the middle of a corner's bisector only by rounding; outside is the claim.
      ASSERT_NEAR(solid.field->value(p - value * solid.field->gradient(p)), 0.0, 1e-9);
      ASSERT_NEAR(glm::length(solid.field->gradient(p)), 1.0, 1e-9);
    });
  }
}

TEST(Primitives, ArePositiveOutsideOfTheirSupportWhichIsTight) {
  for (const Named& solid : bounded_solids()) {
    SCOPED_TRACE(solid.name);
    const std::optional<Box> support = solid.field->support();
    ASSERT_TRUE(support);
    double least = std::numeric_limits<double>::infinity();
    test::for_each_seed(2000, [&](Seed seed) {
      Rng rng(seed, "points");
      const Vec3 p = test::random_point(rng, support->grown(1.0));
      if (!support->contains(p)) {
        ASSERT_GE(solid.field->value(p), -1e-12);
      }
      if (solid.field->value(p) < 0.0) least = std::min(least, support->hi.x - p.x);
    });
    EXPECT_LT(least, solid.name == std::string("torus") ? 0.5 : 0.3);
  }
}

TEST(Primitives, HaveTheirClosedFormValues) {
  EXPECT_DOUBLE_EQ(sphere({1, 2, 3}, 2)->value({1, 2, 6}), 1.0);
  EXPECT_DOUBLE_EQ(box_solid({{0, 0, 0}, {2, 2, 2}})->value({5, 6, 1}), 5.0);
  EXPECT_DOUBLE_EQ(box_solid({{0, 0, 0}, {2, 2, 2}})->value({1, 1, 1.5}), -0.5);
  EXPECT_DOUBLE_EQ(slab(1, 4)->value({9, 9, 3}), -1.0);
  EXPECT_DOUBLE_EQ(cylinder({0, 0, 0}, {0, 0, 4}, 1)->value({4, 0, 8}), 5.0);
  EXPECT_DOUBLE_EQ(cylinder({0, 0, 0}, {0, 0, 4}, 1)->value({0, 0, 2}), -1.0);
  EXPECT_DOUBLE_EQ(capsule({0, 0, 0}, {0, 0, 4}, 1)->value({0, 0, 6}), 1.0);
  EXPECT_DOUBLE_EQ(torus({0, 0, 0}, {0, 0, 2}, 3, 1)->value({3, 0, 2}), 1.0);
}

TEST(Primitives, RefuseBrokenBounds) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)sphere({0, 0, nan}, 1), ParameterError);
  EXPECT_THROW((void)sphere({0, 0, 0}, 0), ParameterError);
  EXPECT_THROW((void)box_solid({{0, 0, 0}, {1, 1, 0}}), ParameterError);
  EXPECT_THROW((void)box_solid({{0, 0, 0}, {1, 1, 1}}, 0.6), ParameterError);
  EXPECT_THROW((void)half_space({{0, 0, 2}, 0}), ParameterError);
  EXPECT_THROW((void)slab(1, 1), ParameterError);
  EXPECT_THROW((void)cylinder({0, 0, 0}, {0, 0, 0}, 1), ParameterError);
  EXPECT_THROW((void)capsule({0, 0, 0}, {0, 0, 1}, -1), ParameterError);
  EXPECT_THROW((void)torus({0, 0, 0}, {0, 0, 1}, 0.5, 1), ParameterError);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/implicit/polytope_union.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "implicit/field_contract.h"
#include "implicit/shapes.h"
#include "outcrop/core/error.h"
#include "outcrop/implicit/combine.h"

namespace outcrop {
namespace {

const Box kRegion{Vec3(-4.0), Vec3(4.0)};

/// Overlapping blocks around jittered places; more of them than are remembered from one look to the next.
std::vector<FieldPtr> blocks(Seed seed, int count, const Warp& warp) {
  Rng rng(seed, "union places");
  std::vector<FieldPtr> result;
  for (int i = 0; i < count; ++i) {
    const Vec3 centre = 3.5 * rng.uniform() * rng.direction();
    const std::vector<Plane> planes = test::random_planes(1000 * seed + i, 14, 1.5, centre);
    result.push_back(std::make_shared<RoundedPolytope>(planes, centre, 0.2, warp));
  }
  return result;
}

TEST(PolytopeUnion, IsTheMinimumOfItsPolytopesToTheBit) {
  const Warp warp{test::noise_relief(3, 64, 64, 4.0), 0.15};
  test::for_each_seed(6, [&](Seed seed) {
    const std::vector<FieldPtr> parts = blocks(seed, 22, seed % 2 ? warp : Warp{});
    const FieldPtr whole = union_of(parts);
    ASSERT_TRUE(std::dynamic_pointer_cast<const PolytopeUnion>(whole));
    Rng rng(seed, "points");
    test::PointList points;
    for (int i = 0; i < 700; ++i) points.push_back(test::random_point(rng, kRegion));
    std::vector<double> values(points.size());
    std::vector<Vec3> gradients(points.size());
    whole->values(points.view(), values, gradients);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto lowest = std::ranges::min_element(parts, {}, [&](const FieldPtr& f) { return f->value(points[i]); });
      ASSERT_EQ(values[i], (*lowest)->value(points[i]));
      ASSERT_EQ(gradients[i], (*lowest)->gradient(points[i]));
    }
  });
}

TEST(PolytopeUnion, PassesTheContractWithAndWithoutARelief) {
  test::check_field_contract(*union_of(blocks(1, 20, {})), kRegion, 3);
  test::check_field_contract(*union_of(blocks(2, 20, {test::noise_relief(5, 64, 64, 4.0), 0.15})), kRegion, 3);
}

TEST(PolytopeUnion, HasAModulusThatForgetsTheRelief) {
  const FieldPtr field = union_of(blocks(2, 5, {test::noise_relief(5, 64, 64, 4.0), 0.15}));
  EXPECT_EQ(field->modulus().slope, 1.0);
  EXPECT_EQ(field->modulus().slack, 0.15);
  EXPECT_GT(field->lipschitz(), 2.0);
}

TEST(PolytopeUnion, RefusesNothing) { EXPECT_THROW(PolytopeUnion({}, {}), ParameterError); }

}  // namespace
}  // namespace outcrop

#include "outcrop/implicit/rounded_polytope.h"

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/field_contract.h"
#include "implicit/shapes.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

constexpr double kRounding = 0.25;  // Paris et al. 2020, section 4.2.
const Box kRegion{Vec3(-2.5), Vec3(2.5)};

[[nodiscard]] std::shared_ptr<const RoundedPolytope> block(Seed seed, double rounding, Warp warp = {},
                                                           Vec3 centre = Vec3(0.0)) {
  return std::make_shared<RoundedPolytope>(test::random_planes(seed, 20, 2.0, centre), centre, rounding,
                                           std::move(warp));
}

TEST(RoundedPolytope, PassesTheContractSharpAndRounded) {
  for (const double rounding : {0.0, 0.05, kRounding, 1.5}) {
    SCOPED_TRACE(rounding);
    test::check_field_contract(*block(1, rounding), kRegion, 4);
  }
}

TEST(RoundedPolytope, PassesTheContractAtWorldCoordinates) {
  const Vec3 centre{4.1e5, 5.2e6, 1234.0};
  const Warp warp{test::noise_relief(3, 64, 64, 4.0), 0.1};
  test::check_field_contract(*block(2, kRounding, warp, centre), kRegion.moved(centre), 3);
}

TEST(RoundedPolytope, PassesTheContractWithReliefsFromGentleToAbsurdlySteep) {
  for (const int pixels : {4, 32, 256})
    for (const double amplitude : {0.02, 0.4}) {
      SCOPED_TRACE(std::to_string(pixels) + " pixels in 4 m, amplitude " + std::to_string(amplitude));
      test::check_field_contract(*block(3, kRounding, {test::noise_relief(5, pixels, pixels, 4.0), amplitude}), kRegion,
                                 3);
    }
}

TEST(RoundedPolytope, OfOnePlaneIsItsDistance) {
  const Plane plane{glm::normalize(Vec3(1, 2, 3)), -0.7};
  const auto field = std::make_shared<RoundedPolytope>(std::vector{plane}, Vec3(0.0), kRounding);
  test::for_each_seed(50, [&](Seed seed) {
    Rng rng(seed, "points");
    const Vec3 p = test::random_point(rng, kRegion);
    ASSERT_NEAR(field->value(p), plane.distance(p), 1e-6);
    ASSERT_NEAR(glm::length(field->gradient(p) - plane.normal), 0.0, 1e-6);
  });
  test::check_field_contract(*field, kRegion, 2);
}

TEST(RoundedPolytope, FoldsItsPlanesInOrderWithTheCubicMaximum) {
  test::for_each_seed(20, [&](Seed seed) {
    const std::vector<Plane> planes = test::random_planes(seed, 20, 2.0);
    const auto field = std::make_shared<RoundedPolytope>(planes, Vec3(0.0), kRounding);
    Rng rng(seed, "points");
    for (int i = 0; i < 50; ++i) {
      const Vec3 p = test::random_point(rng, kRegion);
      double expected = planes[0].distance(p), sharp = expected;
      for (std::size_t k = 1; k < planes.size(); ++k) {
        const double h = planes[k].distance(p);
        const double near = std::max(1.0 - std::abs(expected - h) / kRounding, 0.0);
        expected = std::max(expected, h) + kRounding / 6.0 * near * near * near;
        sharp = std::max(sharp, h);
      }
      ASSERT_NEAR(field->value(p), expected, 3e-6);
      ASSERT_GE(field->value(p), sharp - 3e-6);              // Inside the sharp polytope …
      ASSERT_LE(field->value(p), sharp + kRounding + 3e-6);  // … by R at most.
    }
  });
}

TEST(RoundedPolytope, IsConvexWithoutARelief) {
  const auto field = block(7, kRounding);
  test::for_each_seed(500, [&](Seed seed) {
    Rng rng(seed, "segments");
    const Vec3 a = test::random_point(rng, kRegion);
    const Vec3 b = test::random_point(rng, kRegion);
    ASSERT_LE(field->value(0.5 * (a + b)), 0.5 * (field->value(a) + field->value(b)) + 3e-6);
  });
}

TEST(RoundedPolytope, IsOnlyCarvedByItsReliefAndByNoMoreThanTheAmplitude) {
  const double amplitude = 0.3;
  const auto plain = block(8, kRounding);
  const auto carved = block(8, kRounding, {test::noise_relief(9, 64, 64, 2.0), amplitude});
  test::for_each_seed(2000, [&](Seed seed) {
    Rng rng(seed, "points");
    const Vec3 p = test::random_point(rng, kRegion);
    ASSERT_GE(carved->value(p), plain->value(p) - 3e-6);
    ASSERT_LE(carved->value(p), plain->value(p) + amplitude + 3e-6);
  });
}

TEST(RoundedPolytope, IsLeftAloneByAWhiteReliefAndSunkByTheAmplitudeUnderABlackOne) {
  const double amplitude = 0.1;
  const auto plain = std::make_shared<RoundedPolytope>(test::cube_planes(2.0), Vec3(0.0), kRounding);
  const auto white = std::make_shared<RoundedPolytope>(test::cube_planes(2.0), Vec3(0.0), kRounding,
                                                       Warp{test::flat_relief(1.0f), amplitude});
  const auto black = std::make_shared<RoundedPolytope>(test::cube_planes(2.0), Vec3(0.0), kRounding,
                                                       Warp{test::flat_relief(0.0f), amplitude});
  const Vec3 on_face{2.0, 0.3, -0.4};
  EXPECT_EQ(white->value(on_face), plain->value(on_face));
  EXPECT_NEAR(black->value(on_face), amplitude, 1e-6);
  EXPECT_EQ(black->value(Vec3(0.0)),
            plain->value(Vec3(0.0)));  // Opposite faces cancel in the middle: no direction, no carving.
}

TEST(RoundedPolytope, LooksItsReliefUpByTriplanarProjection) {
  // On the +x face the direction is x alone, so the relief is that of (u, v) = (y, z).
  const ReliefPtr relief = test::noise_relief(4, 16, 16, 1.5);
  const double amplitude = 0.1;
  const Vec3 centre{100.25, -40.5, 7.0};
  const auto field =
      std::make_shared<RoundedPolytope>(test::cube_planes(2.0, centre), centre, kRounding, Warp{relief, amplitude});
  test::for_each_seed(50, [&](Seed seed) {
    Rng rng(seed, "places");
    const double y = rng.uniform(-1.5, 1.5);
    const double z = rng.uniform(-1.5, 1.5);
    const Vec3 p = centre + Vec3(2.0, y, z);
    ASSERT_NEAR(field->value(p), amplitude * (1.0 - relief->at(p.y, p.z).d), 1e-5);
  });
}

TEST(RoundedPolytope, NarrowsToTheFewPlanesThatTouchASmallBox) {
  const PolytopeKernel kernel(test::cube_planes(2.0), kRounding, {}, Vec3(0.0));
  EXPECT_EQ(kernel.narrow(TurnedBox({Vec3(1.9, -0.1, -0.1), Vec3(2.1, 0.1, 0.1)})).plane_count(), 1u);
  EXPECT_EQ(kernel.narrow(TurnedBox({Vec3(1.9, 1.9, -0.1), Vec3(2.1, 2.1, 0.1)})).plane_count(), 2u);
  EXPECT_EQ(kernel.narrow(TurnedBox({Vec3(1.9), Vec3(2.1)})).plane_count(), 3u);
}

TEST(RoundedPolytope, HasASmallLocalLipschitzConstantOnAFaceAndALargerOneAtAnEdge) {
  const Warp warp{test::noise_relief(4, 16, 16, 4.0), 0.05};
  const PolytopeKernel kernel(test::cube_planes(2.0), kRounding, warp, Vec3(0.0));
  const double face = kernel.narrow(TurnedBox({Vec3(1.9, -0.1, -0.1), Vec3(2.1, 0.1, 0.1)})).lipschitz();
  const double edge = kernel.narrow(TurnedBox({Vec3(1.9, 1.9, -0.1), Vec3(2.1, 2.1, 0.1)})).lipschitz();
  EXPECT_NEAR(face, 1.0 + warp.amplitude * warp.relief->slope(), 1e-9);
  EXPECT_GT(edge, face);
  EXPECT_GT(kernel.lipschitz(), edge);
}

TEST(RoundedPolytope, KnowsItsBoxWhenItIsBounded) {
  const Vec3 centre{10.0, 20.0, -5.0};
  const auto cube = std::make_shared<RoundedPolytope>(test::cube_planes(2.0, centre), centre, kRounding);
  ASSERT_TRUE(cube->support());
  EXPECT_NEAR(glm::length(cube->support()->lo - (centre - Vec3(2.0))), 0.0, 1e-3);
  EXPECT_NEAR(glm::length(cube->support()->hi - (centre + Vec3(2.0))), 0.0, 1e-3);
  std::vector<Plane> open = test::cube_planes(2.0);
  open.pop_back();
  EXPECT_FALSE(std::make_shared<RoundedPolytope>(open, Vec3(0.0), kRounding)->support());
}

TEST(RoundedPolytope, RefusesBrokenBounds) {
  const std::vector<Plane> cube = test::cube_planes(1.0);
  const Warp warp{test::flat_relief(0.5f), 0.1};
  EXPECT_THROW(PolytopeKernel({}, kRounding, {}, Vec3(0.0)), ParameterError);
  EXPECT_THROW(PolytopeKernel(cube, -0.1, {}, Vec3(0.0)), ParameterError);
  EXPECT_THROW(PolytopeKernel(cube, 0.0, warp, Vec3(0.0)), ParameterError);
  EXPECT_THROW(PolytopeKernel(cube, kRounding, {warp.relief, -1.0}, Vec3(0.0)), ParameterError);
  EXPECT_THROW(PolytopeKernel(std::vector{Plane{Vec3(0, 0, 2), 0.0}}, kRounding, {}, Vec3(0.0)), ParameterError);
}

}  // namespace
}  // namespace outcrop

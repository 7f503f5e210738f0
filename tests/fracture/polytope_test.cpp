#include "outcrop/fracture/polytope.h"

#include <gtest/gtest.h>

#include <cmath>

#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

constexpr double kTolerance = 1e-9;

void expect_closed(const Polytope& polytope) {
  std::size_t corners = 0;
  for (const Polytope::Face& face : polytope.faces) {
    ASSERT_GE(face.loop.size(), 3u);
    corners += face.loop.size();
    for (const std::uint32_t v : face.loop) ASSERT_NEAR(face.plane.distance(polytope.vertices[v]), 0.0, 1e-8);
    for (const Vec3& v : polytope.vertices) ASSERT_LT(face.plane.distance(v), 1e-8);
  }
  // Euler: V − E + F = 2, every edge in two faces.
  ASSERT_EQ(polytope.vertices.size() + polytope.faces.size(), corners / 2 + 2);
}

TEST(Polytope, CutsInTwoWithoutLosingVolume) {
  for (Seed seed = 1; seed <= 200; ++seed) {
    Rng rng(seed, "cuts");
    Polytope polytope = box_polytope({Vec3(-1, -2, -3), Vec3(2, 2, 1)});
    for (int cut = 0; cut < 12; ++cut) {
      const Vec3 normal = rng.direction();
      const double offset = rng.uniform(-0.7, 0.7) - glm::dot(normal, polytope.middle());
      const Polytope below = clipped(polytope, {normal, offset}, cut, kTolerance);
      const Polytope above = clipped(polytope, {-normal, -offset}, cut, kTolerance);
      ASSERT_NEAR(below.volume() + above.volume(), polytope.volume(), 1e-9);
      if (below.empty()) continue;
      expect_closed(below);
      polytope = below;
    }
  }
}

TEST(Polytope, KeepsSharedCornersWhenAPlanePassesThroughThem) {
  const Polytope cube = box_polytope({Vec3(0.0), Vec3(1.0)});
  const Polytope corner = clipped(cube, {glm::normalize(Vec3(1, 1, 1)), -1.0 / std::sqrt(3.0)}, 0, kTolerance);
  expect_closed(corner);
  EXPECT_NEAR(corner.volume(), 1.0 / 6.0, 1e-12);
  const Polytope wedge = clipped(cube, {glm::normalize(Vec3(1, 1, 0)), -std::sqrt(0.5)}, 0, kTolerance);
  expect_closed(wedge);
  EXPECT_NEAR(wedge.volume(), 0.5, 1e-12);
  EXPECT_EQ(clipped(cube, {Vec3(0, 0, 1), -1.0}, 0, kTolerance).faces.size(), 6u) << "a plane that only touches";
  EXPECT_TRUE(clipped(cube, {Vec3(0, 0, 1), 0.0}, 0, kTolerance).empty());
}

TEST(InscribedBall, IsTheLargestToOnePercent) {
  EXPECT_NEAR(inscribed_ball(box_polytope({Vec3(0.0), Vec3(1, 8, 20)})).radius, 0.5, 0.005);
  // A corner cut off a cube: r = 1 / (3 + √3).
  const Polytope corner = clipped(box_polytope({Vec3(0.0), Vec3(1.0)}),
                                  {glm::normalize(Vec3(1, 1, 1)), -1.0 / std::sqrt(3.0)}, 0, kTolerance);
  const Ball ball = inscribed_ball(corner);
  EXPECT_NEAR(ball.radius, 1.0 / (3.0 + std::sqrt(3.0)), 0.002);
  for (const Polytope::Face& face : corner.faces) EXPECT_LE(face.plane.distance(ball.centre), -ball.radius + 1e-12);
}

}  // namespace
}  // namespace outcrop

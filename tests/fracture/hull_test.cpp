#include "outcrop/fracture/hull.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "outcrop/core/error.h"
#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

TEST(ConvexHull, IsClosedAndHoldsItsPoints) {
  for (Seed seed = 1; seed <= 20; ++seed) {
    Rng rng(seed, "points");
    std::vector<Vec3> points;
    for (int i = 0; i < 60; ++i) points.push_back(rng.direction() * std::cbrt(rng.uniform()));
    const BlockMesh hull = convex_hull(points).value();
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : hull.triangles) {
      for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
      const Vec3 a = hull.vertices[t[0]];
      const Vec3 n = glm::cross(hull.vertices[t[1]] - a, hull.vertices[t[2]] - a);
      for (const Vec3& p : points) ASSERT_LE(glm::dot(n, p - a), 1e-12);
    }
    for (const auto& [edge, uses] : edges) {
      ASSERT_EQ(uses, 1);
      ASSERT_TRUE(edges.count({edge.second, edge.first}));
    }
  }
}

TEST(ThickHull, MakesCubesBarsAndPlatesOfFlatSets) {
  const auto volume_of = [](std::vector<Vec3> points) { return volume(thick_hull(points, 0.5)); };
  EXPECT_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.3, 0.2, 0}}));
  EXPECT_NEAR(volume_of({{1, 2, 3}}), 0.125, 1e-12);
  EXPECT_NEAR(volume_of({{1, 2, 3}, {1, 2, 3}}), 0.125, 1e-12);
  EXPECT_NEAR(volume_of({{0, 0, 0}, {2, 0, 0}}), 2.5 * 0.25, 1e-12);
  EXPECT_NEAR(volume_of({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}}), 2.5 * 2.5 * 0.5, 1e-12);
  EXPECT_NEAR(volume_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), 1.0 / 6.0, 1e-12) << "not flat: left alone";
  EXPECT_THROW((void)thick_hull({}, 1.0), ParameterError);
}

TEST(PrincipalSizes, AreTheEdgesOfABox) {
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0},
                                  {0, 0, 5}, {1, 0, 5}, {0, 2, 5}, {1, 2, 5}};
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  std::vector<Vec3> turned;
  for (const Vec3& p : corners) turned.push_back({c * p.x - s * p.z + 3.0, p.y, s * p.x + c * p.z});
  const auto sizes = principal_sizes(convex_hull(turned).value());
  EXPECT_NEAR(sizes[0], 5.0, 1e-9);
  EXPECT_NEAR(sizes[1], 2.0, 1e-9);
  EXPECT_NEAR(sizes[2], 1.0, 1e-9);
}

}  // namespace
}  // namespace outcrop

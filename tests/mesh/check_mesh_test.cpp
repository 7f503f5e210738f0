#include "outcrop/mesh/check_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace outcrop {
namespace {

/// The corner tetrahedron of the unit cube at `at`; volume 1/6.
TriangleMesh tetrahedron(const Vec3f& at = Vec3f(0.0f)) {
  return {.positions = {at, at + Vec3f(1, 0, 0), at + Vec3f(0, 1, 0), at + Vec3f(0, 0, 1)},
          .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TEST(CheckMesh, FindsNoFaultInATetrahedron) {
  const MeshCheck check = check_mesh(tetrahedron(Vec3f(1000.0f)));
  EXPECT_TRUE(check.closed());
  EXPECT_EQ(check.nonmanifold_vertices, 0u);
  EXPECT_EQ(check.degenerate_triangles, 0u);
  EXPECT_EQ(check.parts, 1u);
  EXPECT_EQ(check.euler, 2);
  EXPECT_NEAR(check.volume, 1.0 / 6.0, 1e-12);
  EXPECT_NEAR(check.area, 1.5 + std::sqrt(3.0) / 2.0, 1e-12);
}

TEST(CheckMesh, CountsTheEdgesOfAHole) {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  EXPECT_EQ(check_mesh(mesh).open_edges, 3u);
  EXPECT_FALSE(check_mesh(mesh).closed());
}

TEST(CheckMesh, FindsAFlippedTriangle) {
  TriangleMesh mesh = tetrahedron();
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.nonmanifold_edges, 3u);
  EXPECT_EQ(check.open_edges, 3u);
}

TEST(CheckMesh, FindsTwoSolidsThatShareAnEdgeOrAVertex) {
  TriangleMesh edge = tetrahedron();
  edge.positions.push_back({-1, 0, 0});
  edge.positions.push_back({0, -1, 0});
  for (const auto& t : tetrahedron().triangles) {
    auto mirrored = t;
    for (auto& v : mirrored) v = v == 1 ? 4 : v == 2 ? 5 : v;
    edge.triangles.push_back(mirrored);
  }
  EXPECT_EQ(check_mesh(edge).nonmanifold_edges, 2u);

  TriangleMesh corner = tetrahedron();
  for (const Vec3f& p : {Vec3f(-1, 0, 0), Vec3f(0, -1, 0), Vec3f(0, 0, 1.5f)}) corner.positions.push_back(p);
  for (const auto& t : tetrahedron().triangles) {
    auto moved = t;
    for (auto& v : moved) v = v == 0 ? 0 : v + 3;
    corner.triangles.push_back(moved);
  }
  const MeshCheck check = check_mesh(corner);
  EXPECT_TRUE(check.closed());
  EXPECT_EQ(check.nonmanifold_vertices, 1u);
}

TEST(CheckMesh, FindsDegenerateTriangles) {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles.push_back({0, 1, 1});
  mesh.positions.push_back({2, 0, 0});
  mesh.triangles.push_back({0, 1, 4});
  EXPECT_EQ(check_mesh(mesh).degenerate_triangles, 2u);
}

TEST(CheckMesh, TakesAnEmptyMesh) {
  const MeshCheck check = check_mesh({});
  EXPECT_TRUE(check.closed());
  EXPECT_EQ(check.parts, 0u);
}

}  // namespace
}  // namespace outcrop

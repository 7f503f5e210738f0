#include "clip_mesh.h"

#include <gtest/gtest.h>

#include "outcrop/implicit/combine.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop {
namespace {

/// n x n unit squares in the plane z = 0, two triangles each.
TriangleMesh sheet(std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) {
      mesh.positions.emplace_back(x, y, 0.0f);
      mesh.normals.emplace_back(0.0f, 0.0f, 1.0f);
      mesh.labels.push_back(static_cast<Label>(x % 2));
    }
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 2, d = a + n + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

TEST(ClipMesh, CutsAlongTheZeroLineAndKeepsTheSheetInOnePiece) {
  const TriangleMesh whole = sheet(20);
  const TriangleMesh disc = clip_mesh(whole, *sphere({10.1, 10.2, 0.0}, 7.3));
  const MeshCheck check = check_mesh(disc);
  EXPECT_EQ(check.parts, 1u);
  EXPECT_EQ(check.euler, 1) << "a disc without holes";
  EXPECT_EQ(check.nonmanifold_edges, 0u);
  EXPECT_EQ(check.degenerate_triangles, 0u);
  EXPECT_NEAR(check.area, kPi * 7.3 * 7.3, 3.0);
  EXPECT_EQ(disc.normals.size(), disc.positions.size());
  EXPECT_EQ(disc.labels.size(), disc.positions.size());
  for (const Vec3f& p : disc.positions) EXPECT_LT(glm::length(Vec3(p) - Vec3(10.1, 10.2, 0.0)), 7.3 + 0.05);
}

TEST(WithoutWalls, AClosedMeshIsTheOpenOne) {
  const FieldPtr solids[] = {sphere({0.3, 0.2, 0.1}, 1.3),                                 // Cut by all sides.
                             sphere({0.0, 0.0, 0.0}, 0.8),                                 // By none.
                             box_solid({{-3.0, -3.0, -3.0}, {1.02, 0.4, 0.2}}, 0.0),       // A face in the last cell.
                             difference_of(slab(-9.0, 0.5), sphere({-1.0, 0.0, 0.5}, 0.7))};  // A bite out of an edge.
  for (const FieldPtr& solid : solids)
    for (const auto& [parts, tolerance] : {std::pair(Parts::All, 0.0), {Parts::Grounded, 0.0}, {Parts::Grounded, 0.02}}) {
      PolygonizeOptions options{
          .region = {Vec3(-1.0), Vec3(1.03)}, .resolution = 0.04, .tolerance = tolerance, .parts = parts};
      const TriangleMesh open = polygonize(*solid, options).mesh;
      options.border = Border::Closed;
      PolygonizeResult closed = polygonize(*solid, options);
      const TriangleMesh made = without_walls(closed.mesh, closed.statistics.extent);
      EXPECT_EQ(made.origin, open.origin);
      EXPECT_EQ(made.positions, open.positions);
      EXPECT_EQ(made.normals, open.normals);
      EXPECT_EQ(made.labels, open.labels);
      EXPECT_EQ(made.triangles, open.triangles);
    }
}

TEST(ClipMesh, LeavesAMeshAloneThatLiesInside) {
  const TriangleMesh whole = sheet(5);
  const TriangleMesh same = clip_mesh(whole, *sphere(Vec3(0.0), 100.0));
  EXPECT_EQ(same.positions.size(), whole.positions.size());
  EXPECT_EQ(same.triangles.size(), whole.triangles.size());
  EXPECT_DOUBLE_EQ(check_mesh(same).area, 25.0);
  EXPECT_TRUE(clip_mesh(whole, *sphere(Vec3(0, 0, 200), 100.0)).positions.empty());
}

}  // namespace
}  // namespace outcrop

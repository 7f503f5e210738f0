/// Vertices on creases: sharper, and as sound as without.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "cell_fan.h"
#include "fields.h"
#include "fields_on_meshes.h"
#include "forced_levels.h"
#include "outcrop/core/parallel.h"
#include "outcrop/implicit/rounded_polytope.h"
#include "self_intersections.h"

namespace outcrop {
namespace {

using test::formula;

/// Blocks with sharp edges that overlap: edges, corners, furrows, slivers, at all angles.
FieldPtr sharp_blocks(Seed seed) {
  using Side = std::pair<Vec3, double>;
  std::vector<std::vector<Side>> blocks(40);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    Rng rng(seed, "sharp block", b);
    Vec3 centre;
    for (int axis = 0; axis < 3; ++axis) centre[axis] = rng.uniform(-1.4, 1.4);
    for (int i = 0; i < 9; ++i) {
      const Vec3 normal = rng.direction();
      blocks[b].emplace_back(normal, -glm::dot(normal, centre) - rng.uniform(0.2, 0.4));
    }
  }
  return formula([=](const Vec3& p) {
    double f = 1e9;
    for (const auto& block : blocks) {
      double inside = -1e9;
      for (const auto& [normal, offset] : block) inside = std::max(inside, glm::dot(normal, p) + offset);
      f = std::min(f, inside);
    }
    return f;
  });
}

/// Random values at the nodes of a lattice, trilinear between them: every case of a cell, with gradients.
FieldPtr trilinear_noise(Seed seed) {
  return formula(
      [=](const Vec3& p) {
        const IVec3 first(glm::floor(p));
        const Vec3 t = p - Vec3(first);
        double sum = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
          const IVec3 at(corner & 1, corner >> 1 & 1, corner >> 2 & 1), node = first + at + 64;
          double weight = 1.0;
          for (int axis = 0; axis < 3; ++axis) weight *= at[axis] == 1 ? t[axis] : 1.0 - t[axis];
          const auto key = static_cast<std::uint64_t>(node.x + 128 * (node.y + 128 * node.z));
          sum += weight * Rng(seed, "node", key).uniform(-1.0, 1.0);
        }
        return sum;
      },
      1e6);
}

PolygonizeOptions cube(double half, double resolution, double tolerance, bool crisp) {
  return {.region = {Vec3(-half), Vec3(half)},
          .resolution = resolution,
          .tolerance = tolerance,
          .crisp = crisp,
          .border = Border::Closed,
          .keep_voids = true};
}

void expect_sound(const TriangleMesh& mesh, const std::string& what) {
  test::expect_solid(mesh, what);
  EXPECT_EQ(test::self_intersections(mesh), 0u) << what;
}

TEST(BoundaryLoop, IsTheOnePolygonOrNothing) {
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  EXPECT_EQ(meshing::boundary_loop(Triangles{{4, 5, 6}}), (std::vector<std::uint32_t>{4, 5, 6}));
  const auto square = meshing::boundary_loop(Triangles{{0, 1, 2}, {0, 2, 3}});
  ASSERT_EQ(square.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(square[(i + 1) % 4], (square[i] + 1) % 4);
  EXPECT_TRUE(meshing::boundary_loop(Triangles{}).empty());
  EXPECT_TRUE(meshing::boundary_loop(Triangles{{0, 1, 2}, {3, 4, 5}}).empty());
  EXPECT_TRUE(meshing::boundary_loop(Triangles{{0, 1, 2}, {0, 3, 4}}).empty());
  EXPECT_TRUE(meshing::boundary_loop(Triangles{{0, 1, 2}, {2, 1, 0}}).empty());
}

TEST(CrispMesh, IsSolidAndFreeOfIntersectionsOnSharpBlocks) {
  for (Seed seed = 0; seed < 3; ++seed) {
    const FieldPtr field = sharp_blocks(seed);
    const std::string what = "seed " + std::to_string(seed);
    const TriangleMesh plain = polygonize(*field, cube(1.6, 0.05, 0.0, false)).mesh;
    const TriangleMesh uniform = polygonize(*field, cube(1.6, 0.05, 0.0, true)).mesh;
    EXPECT_GT(uniform.positions.size(), plain.positions.size() + 2'000) << what;
    expect_sound(uniform, what + ", uniform");
    const TriangleMesh levels = test::mesh_with(*field, cube(1.6, 0.05, 0.01, true), test::random_splits(seed)).mesh;
    expect_sound(levels, what + ", random levels");
  }
}

TEST(CrispMesh, IsSolidAndFreeOfIntersectionsOnNoise) {
  for (Seed seed = 0; seed < 3; ++seed) {
    PolygonizeOptions options = cube(16.3, 1.0, 0.0, true);
    options.region.hi.z = -2.0;
    expect_sound(polygonize(*trilinear_noise(seed), options).mesh, "seed " + std::to_string(seed));
  }
}

TEST(CrispMesh, HasTheEdgesOfATurnedBox) {
  const Vec3 u = glm::normalize(Vec3(1, 0.3, 0.2)), v = glm::normalize(glm::cross(u, Vec3(0.1, 0.2, 1))),
             w = glm::cross(u, v);
  const FieldPtr box = formula([=](const Vec3& p) {
    return std::max({std::abs(glm::dot(p, u)) - 0.7, std::abs(glm::dot(p, v)) - 0.6, std::abs(glm::dot(p, w)) - 0.5});
  });
  const double cell = 0.05;
  const auto distances = [&](bool crisp) {
    const TriangleMesh mesh = polygonize(*box, cube(1.2, cell, 0.0, crisp)).mesh;
    expect_sound(mesh, "box");
    EXPECT_EQ(check_mesh(mesh).euler, 2);
    for (const Vec3f& p : mesh.positions) EXPECT_LT(std::abs(box->value(mesh.origin + Vec3(p))), 0.02 * cell);
    return test::distances_to_surface(mesh, *box, 20'000, 0.1);
  };
  const test::Distances plain = distances(false), crisp = distances(true);
  EXPECT_GT(plain.mean, 0.006 * cell);
  EXPECT_LT(crisp.mean, plain.mean / 3);
  EXPECT_LT(crisp.largest, 1.001 * plain.largest);  // A corner of the box may lie where its cell has two polygons.
}

TEST(CrispMesh, IsThePlainMeshOnSmoothSurfaces) {
  const FieldPtr field = test::ball({0.1, -0.2, 0.05}, 1.0);
  const TriangleMesh plain = polygonize(*field, cube(1.4, 0.05, 0.0, false)).mesh;
  const TriangleMesh crisp = polygonize(*field, cube(1.4, 0.05, 0.0, true)).mesh;
  EXPECT_EQ(plain.positions, crisp.positions);
  EXPECT_EQ(plain.triangles, crisp.triangles);
}

TEST(CrispMesh, IsAsCrispWhereverItsOriginIs) {
  const FieldPtr field = sharp_blocks(7);
  PolygonizeOptions options = cube(1.6, 0.05, 0.0, true);
  options.border = Border::Open;
  const TriangleMesh near = polygonize(*field, options).mesh;
  options.origin = Vec3(-8.1, 16.3, 4.7);
  const TriangleMesh far = polygonize(*field, options).mesh;
  // Fans are judged in the floats of the mesh: one in a thousand may be taken here and not there.
  EXPECT_NEAR(static_cast<double>(near.triangles.size()), static_cast<double>(far.triangles.size()), 20.0);
  for (const Vec3f& p : far.positions)
    ASSERT_LT(std::abs(field->value(far.origin + Vec3(p))), 0.02 * std::sqrt(3.0) * options.resolution);
}

TEST(CrispMesh, GivesTheSameBytesOnAnyNumberOfThreads) {
  const FieldPtr field = sharp_blocks(7);
  const auto mesh_on = [&](int threads) {
    const ThreadLimit limit(threads);
    return polygonize(*field, cube(1.6, 0.02, 0.005, true)).mesh;
  };
  const TriangleMesh one = mesh_on(1), two = mesh_on(2);
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.normals, two.normals);
  EXPECT_EQ(one.triangles, two.triangles);
}

/// A block that a relief carves 4 cm deep.
FieldPtr block_with_relief() {
  Image image{.width = 128, .height = 128, .channels = 1};
  image.pixels.resize(128 * 128);
  Rng rng(1, "relief");
  for (float& pixel : image.pixels) pixel = static_cast<float>(rng.uniform());
  const Warp warp{std::make_shared<const Relief>(Relief(image, 4.0).smoothed(0.15)), 0.04};
  std::vector<Plane> planes;
  for (int i = 0; i < 12; ++i) {
    Rng side(1, "side", i);
    planes.push_back({side.direction(), -side.uniform(0.7, 1.0)});
  }
  return std::make_shared<RoundedPolytope>(planes, Vec3(0.0), 0.2, warp);
}

TEST(Mesh, LiesOnTheSurfaceAtAHundredThousandPointsOfItsTriangles) {
  struct Case {
    std::string name;
    FieldPtr field;
    double tolerance;
    bool crisp;
    double mean, largest;  // In finest cells.
  };
  const double cell = 0.02;
  const FieldPtr waves = test::waves(11, 2.0, 0.0), relief = block_with_relief();
  for (const Case& c : {Case{"smooth, uniform", waves, 0.0, false, 0.005, 0.08},
                        Case{"smooth, adaptive", waves, 0.25 * cell, false, 0.05, 0.4},
                        Case{"relief, uniform", relief, 0.0, false, 0.006, 0.3},
                        Case{"relief, adaptive", relief, 0.1 * cell, false, 0.015, 0.4},
                        Case{"relief, adaptive, crisp", relief, 0.1 * cell, true, 0.015, 0.2}}) {
    PolygonizeOptions options = cube(1.28, cell, c.tolerance, c.crisp);
    options.border = Border::Open;
    const PolygonizeResult made = polygonize(*c.field, options);
    const test::Distances d = test::distances_to_surface(made.mesh, *c.field, 100'000, 0.5);
    RecordProperty(c.name + ": mean, cells", std::to_string(d.mean / cell));
    RecordProperty(c.name + ": largest, cells", std::to_string(d.largest / cell));
    EXPECT_LT(d.mean, c.mean * cell) << c.name << " " << d.mean / cell;
    EXPECT_LT(d.largest, c.largest * cell) << c.name << " " << d.largest / cell;
    int level = 0;
    for (int l = 0; l <= kMaxLevels; ++l)
      if (made.statistics.bricks[l] > 0) level = l;
    for (const Vec3f& p : made.mesh.positions)
      ASSERT_LT(std::abs(c.field->value(made.mesh.origin + Vec3(p))), 0.02 * std::sqrt(3.0) * cell * (1 << level))
          << c.name;
  }
}

}  // namespace
}  // namespace outcrop

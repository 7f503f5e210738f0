/// Bricks of different sizes side by side: one closed surface, whatever the levels.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "fields.h"
#include "fields_on_meshes.h"
#include "forced_levels.h"
#include "outcrop/core/parallel.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"
#include "self_intersections.h"

namespace outcrop {
namespace {

using meshing::BrickPlace;
using test::ball;
using test::expect_solid;
using test::formula;
using test::Meshed;
using test::mesh_with;
using test::random_splits;
using test::waves;

PolygonizeOptions cube(double half, double resolution, double tolerance) {
  return {.region = {Vec3(-half), Vec3(half)},
          .resolution = resolution,
          .tolerance = tolerance,
          .border = Border::Closed,
          .keep_voids = true};
}

int levels_used(const PolygonizeStatistics& statistics) {
  int used = 0;
  for (const std::size_t bricks : statistics.bricks) used += bricks > 0;
  return used;
}

TEST(AdaptiveMesh, IsSolidAndFreeOfIntersectionsAtRandomLevels) {
  for (Seed seed = 0; seed < 4; ++seed) {
    PolygonizeOptions options = cube(3.2, 0.05, 1.0);
    options.region.hi.z = -1.2;
    const FieldPtr field = waves(seed, 0.9 + 0.2 * static_cast<double>(seed), -0.05 + 0.02 * static_cast<double>(seed));
    const Meshed made = mesh_with(*field, options, random_splits(seed));
    const std::string what = "seed " + std::to_string(seed);
    EXPECT_GE(levels_used(made.statistics), 3) << what;
    expect_solid(made.mesh, what);
    EXPECT_EQ(test::self_intersections(made.mesh), 0u) << what;
  }
}

TEST(AdaptiveMesh, IsSolidAndFreeOfIntersectionsOnWhiteNoiseAtRandomLevels) {
  // Random values at the nodes meet every case of every table beside every other, in cells of every size.
  for (Seed seed = 0; seed < 3; ++seed) {
    const FieldPtr noise = formula(
        [=](const Vec3& p) {
          const IVec3 node(glm::floor(p + 0.5));
          const auto key = static_cast<std::uint64_t>((node.x + 64) + 128 * ((node.y + 64) + 128 * (node.z + 64)));
          return Rng(seed, "node", key).uniform(-1.0, 1.0);
        },
        1e6);
    PolygonizeOptions options = cube(32.0, 1.0, 1.0);
    options.region.hi.z = -16.0;
    const Meshed made = mesh_with(*noise, options, random_splits(seed));
    const std::string what = "seed " + std::to_string(seed);
    EXPECT_GE(levels_used(made.statistics), 2) << what;
    expect_solid(made.mesh, what);
    EXPECT_EQ(test::self_intersections(made.mesh), 0u) << what;
  }
}

TEST(AdaptiveMesh, IsTheUniformMeshWhereEverythingIsSplit) {
  const FieldPtr field = waves(3, 1.1, -0.05);
  PolygonizeOptions uniform = cube(1.6, 0.05, 0.0);
  const TriangleMesh mesh = polygonize(*field, uniform).mesh;
  EXPECT_EQ(test::self_intersections(mesh), 0u);
  const MeshCheck all = check_mesh(mesh);
  const auto always = [](const BrickPlace&) { return true; };
  const MeshCheck split = check_mesh(mesh_with(*field, cube(1.6, 0.05, 1.0), always).mesh);
  EXPECT_EQ(all.triangles, split.triangles);
  EXPECT_DOUBLE_EQ(all.volume, split.volume);
}

TEST(AdaptiveMesh, KnowsTheTopologyOfBallsAndATorus) {
  const auto check = [](const FieldPtr& field, double half) {
    const TriangleMesh mesh = polygonize(*field, cube(half, half / 64, half / 256)).mesh;
    expect_solid(mesh, "shape");
    EXPECT_EQ(test::self_intersections(mesh), 0u);
    return check_mesh(mesh);
  };
  EXPECT_EQ(check(ball({0.1, -0.2, 0.05}, 1.0), 1.4).euler, 2);
  const auto torus = formula([](const Vec3& p) { return std::hypot(std::hypot(p.x, p.y) - 1.0, p.z) - 0.3; });
  EXPECT_EQ(check(torus, 1.5).euler, 0);
  const auto two = formula(
      [](const Vec3& p) { return std::min(glm::length(p - Vec3(1.1, 0, 0)), glm::length(p + Vec3(1.1, 0, 0))) - 1.0; });
  EXPECT_EQ(check(two, 2.2).euler, 4);
  EXPECT_EQ(check(two, 2.2).parts, 2u);
}

/// Smooth hills with a heap of small balls on them: rough in one place, calm elsewhere.
FieldPtr rough_spot() {
  const auto hills = [](double x, double y) { return 0.15 * std::sin(0.9 * x) * std::cos(0.7 * y); };
  std::vector<Vec3> centres;
  for (std::uint64_t i = 0; i < 30; ++i) {
    Rng rng(5, "heap", i);
    const double x = rng.uniform(-0.4, 0.4), y = rng.uniform(-0.4, 0.4), z = rng.uniform(-0.05, 0.05);
    centres.emplace_back(x, y, hills(x, y) + z);
  }
  return formula(
      [=](const Vec3& p) {
        double f = p.z - hills(p.x, p.y);
        for (const Vec3& c : centres) f = std::min(f, glm::length(p - c) - 0.12);
        return f;
      },
      1.2);
}

TEST(AdaptiveMesh, IsFineWhereTheSurfaceIsRoughAndNowhereElse) {
  const FieldPtr field = rough_spot();
  const double resolution = 0.02, tolerance = 0.005;
  PolygonizeOptions options{.region = {{-4, -4, -1}, {4, 4, 1}}, .resolution = resolution, .border = Border::Open};
  const TriangleMesh uniform = polygonize(*field, options).mesh;
  options.tolerance = tolerance;
  const PolygonizeResult adaptive = polygonize(*field, options);
  EXPECT_LT(8 * adaptive.mesh.triangles.size(), uniform.triangles.size());
  EXPECT_GE(levels_used(adaptive.statistics), 4);
  const test::Distances fine = test::distances_to_surface(uniform, *field, 20'000, 0.1);
  const test::Distances coarse = test::distances_to_surface(adaptive.mesh, *field, 20'000, 0.1);
  // The worst place is a crease between balls, in the finest cells of both.
  EXPECT_LT(coarse.largest, 1.2 * fine.largest);
  EXPECT_LT(coarse.mean, tolerance / 2);
}

TEST(AdaptiveMesh, KeepsToItsToleranceOnSmoothSurfaces) {
  const FieldPtr field = waves(11, 2.0, 0.0);
  for (const double tolerance : {0.02, 0.005, 0.002}) {
    PolygonizeOptions options = cube(2.56, 0.02, tolerance);
    options.border = Border::Open;
    const PolygonizeResult made = polygonize(*field, options);
    const test::Distances d = test::distances_to_surface(made.mesh, *field, 20'000, 0.5);
    // The error is sampled, so a little more may slip through.
    EXPECT_LT(d.largest, 1.5 * tolerance) << tolerance;
    EXPECT_LT(d.mean, 0.3 * tolerance) << tolerance;
    EXPECT_GT(levels_used(made.statistics), 0) << tolerance;
    EXPECT_GT(made.statistics.bricks[tolerance > 0.01 ? 3 : 1], 0u) << tolerance;
  }
}

TEST(AdaptiveMesh, PutsVerticesOnTheSurfaceWithItsNormals) {
  const Vec3 centre(0.1, -0.2, 0.05);
  const double resolution = 0.01;
  const PolygonizeResult made = polygonize(*ball(centre, 1.0), cube(1.28, resolution, 0.004));
  int level = 0;
  for (int l = 0; l <= kMaxLevels; ++l)
    if (made.statistics.bricks[l] > 0) level = l;
  EXPECT_GE(level, 2);
  const double cell = resolution * (1 << level);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < made.mesh.positions.size(); ++v) {
    const Vec3 p = made.mesh.origin + Vec3(made.mesh.positions[v]) - centre;
    const double distance = std::abs(glm::length(p) - 1.0);
    EXPECT_LT(distance, std::sqrt(3.0) * cell / 50);
    if (distance > cell / 1000) ++moved;
    EXPECT_GT(glm::dot(Vec3(made.mesh.normals[v]), glm::normalize(p)), 1.0 - 1e-5);
  }
  EXPECT_LT(static_cast<double>(moved), 0.06 * static_cast<double>(made.mesh.positions.size()));
}

TEST(AdaptiveMesh, ClosesTheRegionWithWallsAndFloor) {
  PolygonizeOptions options{.region = {{-4, -4, -1.3}, {4, 4, 1.1}}, .resolution = 0.02, .tolerance = 0.01};
  options.border = Border::Closed;
  const TriangleMesh mesh = polygonize(*rough_spot(), options).mesh;
  expect_solid(mesh, "hills");
  EXPECT_EQ(check_mesh(mesh).parts, 1u);
  EXPECT_EQ(check_mesh(mesh).euler, 2);
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_EQ(mesh.labels.size(), mesh.positions.size());
  EXPECT_EQ(test::self_intersections(mesh), 0u);
  // Sideways the mesh ends where it was asked to.
  EXPECT_NEAR(mesh.bounds().hi.x, 4.0, 1e-6);
  EXPECT_NEAR(mesh.bounds().hi.y, 4.0, 1e-6);
  EXPECT_NEAR(mesh.bounds().lo.z, -1.3, 1e-6);
}

TEST(AdaptiveMesh, RemovesWhatFloatsAndVoids) {
  const FieldPtr hills = rough_spot();
  const FieldPtr field = formula(
      [=](const Vec3& p) {
        const double stone = std::abs(glm::length(p - Vec3(2, 1, 0.6)) - 0.2) - 0.08;
        const double cave = 0.15 - glm::length(p - Vec3(-2, 1, -0.6));
        return std::max(std::min(hills->value(p), stone), cave);
      },
      1.2);
  PolygonizeOptions options{.region = {{-4, -4, -1}, {4, 4, 1}}, .resolution = 0.02, .tolerance = 0.005};
  options.parts = Parts::Grounded;
  for (const Border border : {Border::Open, Border::Closed}) {
    options.border = border;
    const PolygonizeResult made = polygonize(*field, options);
    EXPECT_EQ(made.statistics.parts_removed, 1u);
    EXPECT_EQ(made.statistics.voids_removed, 2u);
    EXPECT_EQ(check_mesh(made.mesh).parts, 1u);
  }
}

TEST(AdaptiveMesh, IsSolidWhereverPlanesRunThroughNodes) {
  // Through corners, edges and faces of cells of several sizes, and of the region; a spot forces all levels.
  const Vec3 spot(0.31, -0.22, 0.0);
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 1, 1), Vec3(-1, 2, 3), Vec3(1, 0, -1)})
    for (const double distance : {0.0, 1e-9, 0.4, 0.37}) {
      const Vec3 n = glm::normalize(normal);
      const FieldPtr field = formula([=](const Vec3& p) {
        const double plane = glm::dot(n, p) - distance;
        return std::min(plane, glm::length(p - (spot + (distance - glm::dot(n, spot)) * n)) - 0.11);
      });
      const Meshed made = mesh_with(*field, cube(1.6, 0.025, 0.004), {});
      EXPECT_GE(levels_used(made.statistics), 3);
      expect_solid(made.mesh, "plane");
      EXPECT_EQ(check_mesh(made.mesh).euler, 2);
      EXPECT_EQ(test::self_intersections(made.mesh), 0u);
    }
}

/// A plate or a crack across the middle of a region, `thickness` finest cells wide, `tilt` off the lattice.
MeshCheck plate_or_crack(bool plate, double thickness, double shift, double tilt) {
  const double resolution = 0.05;
  const Vec3 normal = glm::normalize(Vec3(0.3 * tilt, 0.2 * tilt, 1.0));
  const FieldPtr field = formula([=](const Vec3& p) {
    const double off = std::abs(glm::dot(p, normal) - shift * resolution) - 0.5 * thickness * resolution;
    return plate ? off : -off;
  });
  const TriangleMesh mesh = polygonize(*field, cube(1.6, resolution, 0.02)).mesh;
  if (!mesh.triangles.empty()) expect_solid(mesh, "plate or crack");
  return check_mesh(mesh);
}

TEST(AdaptiveMesh, ShowsPlatesAndCracksThatNodesFallInto) {
  // Thicker than a finest cell along the lattice: whole, wherever they lie and however coarse the cells around them.
  for (const double shift : {0.0, 0.3, 0.5, 7.9}) {
    const MeshCheck plate = plate_or_crack(true, 1.1, shift, 0.0), crack = plate_or_crack(false, 1.1, shift, 0.0);
    EXPECT_EQ(plate.parts, 1u) << shift;
    EXPECT_NEAR(plate.volume, 3.2 * 3.2 * 1.1 * 0.05, 0.05 * 3.2 * 3.2 * 0.05) << shift;
    EXPECT_EQ(crack.parts, 2u) << shift;
  }
  // Thinner ones are whole where a layer of nodes lies in them, and else are not there: no tatters.
  for (const double thickness : {0.9, 0.5})
    for (const double shift : {0.0, 0.3, 0.5}) {
      const bool holds_nodes = shift < 0.5 * thickness;
      EXPECT_EQ(plate_or_crack(true, thickness, shift, 0.0).parts, holds_nodes ? 1u : 0u) << thickness << " " << shift;
      EXPECT_EQ(plate_or_crack(false, thickness, shift, 0.0).parts, holds_nodes ? 2u : 1u) << thickness << " " << shift;
    }
  // Across the lattice they show as stripes and holes: solid all the same.
  for (const double thickness : {1.1, 0.9, 0.5}) {
    EXPECT_GT(plate_or_crack(true, thickness, 0.3, 1.0).parts, 0u);
    EXPECT_GT(plate_or_crack(false, thickness, 0.3, 1.0).parts, 0u);
  }
}

TEST(AdaptiveMesh, FindsStonesThatLieBetweenCoarseNodes) {
  // Flat ground with a stone 10 finest cells across above it, in cells up to 16 times the finest.
  for (std::uint64_t i = 0; i < 20; ++i) {
    Rng rng(3, "stone", i);
    const double x = rng.uniform(-2.0, 2.0), y = rng.uniform(-2.0, 2.0), z = rng.uniform(0.15, 0.6);
    const Vec3 centre(x, y, z);
    const FieldPtr field = formula([=](const Vec3& p) { return std::min(p.z, glm::length(p - centre) - 0.1); });
    const TriangleMesh mesh = polygonize(*field, cube(2.56, 0.02, 0.002)).mesh;
    EXPECT_EQ(check_mesh(mesh).parts, 2u) << "stone " << i;
  }
}

TEST(AdaptiveMesh, ReportsItsSmallestAngle) {
  // Vertices keep off the ends of their edges, so that no angle is 0; marching cubes promise no more.
  PolygonizeOptions options{.region = {{-4, -4, -1}, {4, 4, 1}}, .resolution = 0.02, .tolerance = 0.005};
  const double angle = test::smallest_angle(polygonize(*rough_spot(), options).mesh);
  RecordProperty("smallest_angle_deg", std::to_string(angle));
  EXPECT_GT(angle, 0.2);
}

TEST(AdaptiveMesh, HasAboutAsManyTrianglesAsAskedFor) {
  PolygonizeOptions options{.region = {{-4, -4, -1}, {4, 4, 1}}, .resolution = 0.02};
  const FieldPtr field = rough_spot();
  // All of the finest cells make about 330 000.
  for (const std::size_t wanted : {10'000, 40'000, 200'000, 500'000}) {
    options.triangles = wanted;
    const PolygonizeResult made = polygonize(*field, options);
    EXPECT_NEAR(static_cast<double>(made.mesh.triangles.size()), static_cast<double>(wanted), 0.1 * wanted);
    EXPECT_EQ(made.statistics.tolerance == 0.0, wanted == 500'000);
    EXPECT_EQ(made.statistics.resolution < options.resolution, wanted == 500'000);
  }
}

TEST(AdaptiveMesh, HasAboutAsManyTrianglesAsAskedForInSmallScenes) {
  // A hundred cells across: few bricks, large steps, and coarsest cells that are too many for the smallest number.
  const FieldPtr field = formula([](const Vec3& p) {
    const double plate = std::max(std::hypot(p.x, p.y) - 1.6, std::abs(p.z + 0.5) - 0.2);
    return std::min(glm::length(p - Vec3(0, 0, 0.4)) - 0.8, plate);
  });
  PolygonizeOptions options{.region = {{-2.5, -2.5, -1}, {2.5, 2.5, 1.6}}, .resolution = 0.05};
  for (const std::size_t wanted : {1'500, 3'000, 6'000, 12'000, 20'000, 50'000}) {
    options.triangles = wanted;
    const double made = static_cast<double>(polygonize(*field, options).mesh.triangles.size());
    EXPECT_NEAR(made, static_cast<double>(wanted), 0.1 * static_cast<double>(wanted));
  }
}

TEST(AdaptiveMesh, GivesTheSameBytesOnAnyNumberOfThreads) {
  const FieldPtr field = rough_spot();
  PolygonizeOptions options{.region = {{-4, -4, -1}, {4, 4, 1}}, .resolution = 0.02, .tolerance = 0.004};
  const auto mesh_on = [&](int threads) {
    const ThreadLimit limit(threads);
    return polygonize(*field, options).mesh;
  };
  const TriangleMesh one = mesh_on(1), two = mesh_on(2);
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.normals, two.normals);
  EXPECT_EQ(one.triangles, two.triangles);
}

TEST(AdaptiveMesh, IsTheSameFiveThousandKilometresAway) {
  const FieldPtr near = rough_spot();
  const Vec3 offset(5e6, -5e6, 2.5e5);
  const FieldPtr far = formula([=](const Vec3& p) { return near->value(p - offset); }, near->lipschitz());
  PolygonizeOptions options{.region = {{-2, -2, -1}, {2, 2, 1}}, .resolution = 0.02, .tolerance = 0.005};
  const TriangleMesh a = polygonize(*near, options).mesh;
  options.region = options.region.moved(offset);
  const TriangleMesh b = polygonize(*far, options).mesh;
  ASSERT_EQ(a.triangles, b.triangles);
  for (std::size_t v = 0; v < a.positions.size(); ++v) EXPECT_LT(glm::length(a.positions[v] - b.positions[v]), 1e-3f);
}

}  // namespace
}  // namespace outcrop

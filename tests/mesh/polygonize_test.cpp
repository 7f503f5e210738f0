#include "outcrop/mesh/polygonize.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <string>

#include "fields.h"
#include "outcrop/core/parallel.h"
#include "outcrop/mesh/check_mesh.h"

namespace outcrop {
namespace {

using test::ball;
using test::formula;
using test::half_space_below;
using test::waves;

PolygonizeOptions cube(double half, double resolution, Border border = Border::Closed) {
  return {.region = {Vec3(-half), Vec3(half)}, .resolution = resolution, .border = border};
}

void expect_solid(const TriangleMesh& mesh, const std::string& what) {
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.open_edges, 0u) << what;
  EXPECT_EQ(check.nonmanifold_edges, 0u) << what;
  EXPECT_EQ(check.nonmanifold_vertices, 0u) << what;
  EXPECT_EQ(check.degenerate_triangles, 0u) << what;
  EXPECT_GT(check.volume, 0.0) << what;
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size()) << what;
  EXPECT_EQ(mesh.labels.size(), mesh.positions.size()) << what;
}

bool same_bytes(const TriangleMesh& a, const TriangleMesh& b) {
  const auto same = [](const auto& u, const auto& v) {
    return u.size() == v.size() && std::memcmp(u.data(), v.data(), u.size() * sizeof(u[0])) == 0;
  };
  return a.origin == b.origin && same(a.positions, b.positions) && same(a.normals, b.normals) &&
         same(a.labels, b.labels) && same(a.triangles, b.triangles);
}

TEST(Polygonize, MeshesABallToItsVolumeAreaAndEulerNumber) {
  const TriangleMesh mesh = polygonize(*ball({0.1, -0.2, 0.05}, 1.0), cube(1.4, 0.05)).mesh;
  expect_solid(mesh, "ball");
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.euler, 2);
  EXPECT_EQ(check.parts, 1u);
  // Chords of length h under a curvature of 1 lose about h²/8 of the radius.
  EXPECT_NEAR(check.volume, 4.0 / 3.0 * kPi, 0.01);
  EXPECT_NEAR(check.area, 4.0 * kPi, 0.02);
}

TEST(Polygonize, PutsVerticesOnTheSurfaceWithItsNormals) {
  const Vec3 centre(0.1, -0.2, 0.05);
  const double resolution = 0.07;
  const TriangleMesh mesh = polygonize(*ball(centre, 1.0), cube(1.4, resolution)).mesh;
  std::size_t moved = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = mesh.origin + Vec3(mesh.positions[v]) - centre;
    const double distance = std::abs(glm::length(p) - 1.0);
    EXPECT_LT(distance, resolution / 50);
    if (distance > resolution / 1000) ++moved;
    EXPECT_GT(glm::dot(Vec3(mesh.normals[v]), glm::normalize(p)), 1.0 - 1e-5);
  }
  // Only vertices within 2 % of an end of their edge may be off: on average 4 % of them.
  EXPECT_LT(static_cast<double>(moved), 0.06 * static_cast<double>(mesh.positions.size()));
}

TEST(Polygonize, MeshesATorusWithItsHole) {
  const FieldPtr torus = formula([](const Vec3& p) { return std::hypot(std::hypot(p.x, p.y) - 1.0, p.z) - 0.3; });
  const TriangleMesh mesh = polygonize(*torus, cube(1.5, 0.06)).mesh;
  expect_solid(mesh, "torus");
  EXPECT_EQ(check_mesh(mesh).euler, 0);
  EXPECT_NEAR(check_mesh(mesh).volume, 2.0 * kPi * kPi * 0.09, 0.02);
}

TEST(Polygonize, KeepsTwoBallsApart) {
  const FieldPtr balls = formula(
      [](const Vec3& p) { return std::min(glm::length(p - Vec3(1.1, 0, 0)), glm::length(p + Vec3(1.1, 0, 0))) - 1.0; });
  const TriangleMesh mesh = polygonize(*balls, cube(2.2, 0.1)).mesh;
  expect_solid(mesh, "two balls");
  EXPECT_EQ(check_mesh(mesh).parts, 2u);
  EXPECT_EQ(check_mesh(mesh).euler, 4);
}

TEST(Polygonize, RemovesAVoidUnlessAskedToKeepIt) {
  const FieldPtr hollow = formula([](const Vec3& p) { return std::abs(glm::length(p) - 0.8) - 0.2; });
  PolygonizeOptions options = cube(1.2, 0.08);
  const PolygonizeResult full = polygonize(*hollow, options);
  expect_solid(full.mesh, "hollow ball, filled");
  EXPECT_EQ(full.statistics.voids_removed, 1u);
  EXPECT_EQ(check_mesh(full.mesh).euler, 2);
  options.keep_voids = true;
  const PolygonizeResult kept = polygonize(*hollow, options);
  expect_solid(kept.mesh, "hollow ball");
  EXPECT_EQ(kept.statistics.voids_removed, 0u);
  EXPECT_EQ(check_mesh(kept.mesh).euler, 4);
  EXPECT_NEAR(check_mesh(kept.mesh).volume, 4.0 / 3.0 * kPi * (1.0 - 0.216), 0.05);
}

TEST(Polygonize, RemovesRockInsideAVoidTogetherWithIt) {
  const FieldPtr rattle = formula([](const Vec3& p) {
    const double r = glm::length(p);
    return std::min(std::abs(r - 0.9) - 0.15, r - 0.3);
  });
  PolygonizeOptions options = cube(1.2, 0.08);
  const PolygonizeResult full = polygonize(*rattle, options);
  EXPECT_EQ(full.statistics.voids_removed, 1u);
  EXPECT_EQ(full.statistics.parts_removed, 1u);
  EXPECT_EQ(check_mesh(full.mesh).parts, 1u);
  options.keep_voids = true;
  EXPECT_EQ(check_mesh(polygonize(*rattle, options).mesh).parts, 3u);
}

TEST(Polygonize, RemovesTheVoidOfARockThatItRemoves) {
  const FieldPtr field = formula([](const Vec3& p) {
    const double floating = std::abs(glm::length(p - Vec3(0, 0, 1)) - 0.5) - 0.15;
    return std::min(p.z + 1.0, floating);
  });
  PolygonizeOptions options = cube(2.0, 0.1);
  options.parts = Parts::Grounded;
  options.keep_voids = true;
  const PolygonizeResult result = polygonize(*field, options);
  expect_solid(result.mesh, "ground below a hollow ball");
  EXPECT_EQ(result.statistics.parts_removed, 1u);
  EXPECT_EQ(result.statistics.voids_removed, 1u);
  EXPECT_NEAR(check_mesh(result.mesh).volume, 16.0, 16.0 * 0.1 / 50);  // The plane runs through nodes.
}

TEST(Polygonize, ClosesPlanesAtTheRegionHoweverTheyCutIt) {
  // Through nodes, edges and corners of the lattice and of the region, and in general position.
  const Vec3 normals[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0},         {0, 1, 1},
                          {1, 1, 1}, {-1, 2, 3}, {0.3, -0.4, 0.86}, {1, -1, 0}};
  const double distances[] = {-1.0, -0.5, -1e-9, 0.0, 1e-9, 0.25, 0.37, 0.999999999, 1.0};
  for (const Vec3& normal : normals) {
    for (const double distance : distances) {
      const std::string what = "normal " + std::to_string(normal.x) + " " + std::to_string(normal.y) + " " +
                               std::to_string(normal.z) + " distance " + std::to_string(distance);
      const TriangleMesh mesh = polygonize(*half_space_below(normal, distance), cube(1.0, 0.125)).mesh;
      if (mesh.triangles.empty()) {
        EXPECT_LE(distance, -1.0) << what;
        continue;
      }
      expect_solid(mesh, what);
      EXPECT_EQ(check_mesh(mesh).euler, 2) << what;
      if (normal.x == 0 && normal.y == 0) {
        EXPECT_NEAR(check_mesh(mesh).volume, 4.0 * (1.0 + distance), 4.0 * 0.125 / 40) << what;
      }
    }
  }
}

TEST(Polygonize, ClosesABallWhereverTheRegionCutsIt) {
  for (const Vec3& centre : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(-1, 0.3, 1), Vec3(0.9, 0.9, -0.2)}) {
    const TriangleMesh mesh = polygonize(*ball(centre, 0.75), cube(1.0, 0.125)).mesh;
    expect_solid(mesh, "ball at the border");
    EXPECT_EQ(check_mesh(mesh).euler, 2);
  }
}

TEST(Polygonize, TurnsSolidRockIntoTheRegionsBox) {
  const TriangleMesh mesh = polygonize(*formula([](const Vec3&) { return -1.0; }), cube(1.0, 0.3)).mesh;
  expect_solid(mesh, "all rock");
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_NEAR(check_mesh(mesh).volume, 2.1 * 2.1 * 2.1, 1e-5);  // Seven whole cells.
  EXPECT_TRUE(polygonize(*formula([](const Vec3&) { return 1.0; }), cube(1.0, 0.3)).mesh.triangles.empty());
}

TEST(Polygonize, MakesASolidOfEveryRoughField) {
  for (Seed seed = 0; seed < 24; ++seed) {
    const double offset = -0.3 + 0.025 * static_cast<double>(seed);
    PolygonizeOptions options{
        .region = {{-2.0, -1.5, -1.0}, {2.0, 1.7, 1.3}}, .resolution = 0.11, .border = Border::Closed};
    const FieldPtr field = waves(seed, 0.7, offset);
    const std::string what = "seed " + std::to_string(seed);
    options.keep_voids = true;
    const TriangleMesh all = polygonize(*field, options).mesh;
    expect_solid(all, what);
    options.keep_voids = false;
    const PolygonizeResult filled = polygonize(*field, options);
    expect_solid(filled.mesh, what + ", filled");
    EXPECT_GE(check_mesh(filled.mesh).volume, check_mesh(all).volume) << what;
    options.parts = Parts::Largest;
    const TriangleMesh largest = polygonize(*field, options).mesh;
    expect_solid(largest, what + ", largest");
    EXPECT_EQ(check_mesh(largest).parts, 1u) << what;
  }
}

TEST(Polygonize, MeshesRandomSignsAtTheNodesWithoutADefect) {
  // White noise at the nodes meets every case of the table beside every other.
  for (Seed seed = 0; seed < 8; ++seed) {
    const FieldPtr field = formula(
        [=](const Vec3& p) {
          const IVec3 node(glm::floor(p + 0.5));
          const auto key = static_cast<std::uint64_t>((node.x + 64) + 128 * ((node.y + 64) + 128 * (node.z + 64)));
          return Rng(seed, "node", key).uniform(-1.0, 1.0);
        },
        1e6);
    PolygonizeOptions options = cube(10.0, 1.0);
    options.keep_voids = true;
    const MeshCheck check = check_mesh(polygonize(*field, options).mesh);
    EXPECT_TRUE(check.closed()) << "seed " << seed;
    EXPECT_EQ(check.nonmanifold_vertices, 0u) << "seed " << seed;
    EXPECT_EQ(check.degenerate_triangles, 0u) << "seed " << seed;
  }
}

TEST(Polygonize, MeshesPlatesThinnerThanACellWithoutADefect) {
  for (const double thickness : {0.3, 0.12, 0.05, 0.01}) {
    const FieldPtr plate = formula(
        [=](const Vec3& p) { return std::abs(glm::dot(p, glm::normalize(Vec3(0.1, 0.2, 1.0)))) - thickness / 2; });
    const TriangleMesh mesh = polygonize(*plate, cube(1.0, 0.1)).mesh;
    if (!mesh.triangles.empty()) expect_solid(mesh, "plate of " + std::to_string(thickness));
  }
}

TEST(Polygonize, LeavesTheSheetOpenAtTheBorderAlone) {
  const FieldPtr ground = formula([](const Vec3& p) { return p.z - 0.2 * std::sin(3 * p.x) * std::cos(2 * p.y); }, 1.3);
  const TriangleMesh mesh = polygonize(*ground, cube(1.0, 0.05, Border::Open)).mesh;
  const MeshCheck check = check_mesh(mesh);
  EXPECT_GT(check.open_edges, 0u);
  EXPECT_EQ(check.nonmanifold_edges, 0u);
  EXPECT_EQ(check.euler, 1);
  const auto on_border = [&](std::uint32_t v) {
    const Vec3 p = mesh.origin + Vec3(mesh.positions[v]);
    return std::max(std::abs(p.x), std::abs(p.y)) > 1.0 - 1e-6;
  };
  std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) sides.emplace(t[i], t[(i + 1) % 3]);
  for (const auto& [a, b] : sides) EXPECT_TRUE(sides.contains({b, a}) || (on_border(a) && on_border(b)));
}

TEST(Polygonize, KeepsNothingThatFloatsNotEvenBesideAnOpenBorder) {
  const FieldPtr field = formula([](const Vec3& p) {
    const double middle = glm::length(p - Vec3(0, 0, 1)) - 0.4, border = glm::length(p - Vec3(2, 0, 1)) - 0.4;
    return std::min(p.z + 0.5, std::min(middle, border));
  });
  PolygonizeOptions options = cube(2.0, 0.1, Border::Open);
  options.parts = Parts::Grounded;
  const PolygonizeResult result = polygonize(*field, options);
  EXPECT_EQ(result.statistics.parts_removed, 2u);
  EXPECT_NEAR(result.mesh.bounds().hi.z, -0.5, 0.01);
  EXPECT_NEAR(check_mesh(result.mesh).area, 16.0, 1e-3);
}

TEST(Polygonize, KeepsTheLargestPartWhereNoneReachesTheFloor) {
  const FieldPtr field = formula([](const Vec3& p) {
    return std::min(glm::length(p - Vec3(0.7, 0, 0)) - 0.5, glm::length(p + Vec3(0.7, 0, 0)) - 0.3);
  });
  PolygonizeOptions options = cube(1.5, 0.1);
  options.parts = Parts::Grounded;
  const TriangleMesh mesh = polygonize(*field, options).mesh;
  EXPECT_NEAR(mesh.bounds().lo.x, 0.2, 0.01);
}

TEST(Polygonize, GivesTheSameBytesOnAnyNumberOfThreads) {
  const FieldPtr field = waves(5, 1.1, -0.05);
  for (const Border border : {Border::Open, Border::Closed}) {
    const auto mesh_on = [&](int threads) {
      const ThreadLimit limit(threads);
      return polygonize(*field, cube(2.5, 0.05, border)).mesh;
    };
    const TriangleMesh one = mesh_on(1);
    EXPECT_GT(one.triangles.size(), 50'000u);
    EXPECT_TRUE(same_bytes(one, mesh_on(2)));
  }
}

TEST(Polygonize, GivesTheSameMeshFiveThousandKilometresAway) {
  const FieldPtr near = waves(3, 0.9, 0.0);
  const Vec3 offset(5e6, -5e6, 2.5e5);
  const FieldPtr far = formula([=](const Vec3& p) { return near->value(p - offset); }, near->lipschitz());
  const PolygonizeOptions here = cube(1.0, 0.0625);
  PolygonizeOptions there = here;
  there.region = here.region.moved(offset);
  const TriangleMesh a = polygonize(*near, here).mesh, b = polygonize(*far, there).mesh;
  ASSERT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(b.origin, there.region.lo);
  for (std::size_t v = 0; v < a.positions.size(); ++v) EXPECT_LT(glm::length(a.positions[v] - b.positions[v]), 1e-3f);
}

TEST(Polygonize, NarrowsOnTheWayDownAndEvaluatesOnlyNearTheSurface) {
  const PolygonizeResult result = polygonize(*ball(Vec3(0), 1.0), cube(1.28, 0.01, Border::Open));
  // 9³ nodes for each of the bricks along the surface and some beside it, against 257³ nodes.
  EXPECT_LT(result.statistics.evaluations, 40 * result.statistics.cells);
  EXPECT_LT(result.statistics.evaluations, 257u * 257 * 257 / 3);
  EXPECT_NEAR(static_cast<double>(result.statistics.cells), result.mesh.triangles.size() / 2.0,
              0.1 * result.mesh.triangles.size());
}

TEST(Polygonize, EstimatesTrianglesWithinATenth) {
  for (const FieldPtr& field : {waves(1, 1.5, 0.0), ball(Vec3(0.2), 2.5)}) {
    const PolygonizeOptions options = cube(3.0, 0.04, Border::Open);
    const auto expected = static_cast<double>(estimate_polygonize(*field, options).triangles);
    const auto found = static_cast<double>(polygonize(*field, options).mesh.triangles.size());
    EXPECT_NEAR(expected / found, 1.0, 0.1);
  }
}

TEST(Polygonize, NamesTheResolutionThatFitsTheMemoryLimit) {
  PolygonizeOptions options = cube(1.28, 0.01);
  options.memory_limit = 1 << 20;
  double fits = 0.0;
  try {
    (void)polygonize(*ball(Vec3(0), 1.0), options);
    FAIL() << "accepted";
  } catch (const ParameterError& e) {
    ASSERT_EQ(std::sscanf(e.what(), "resolution: expected at least %lf m for a memory limit of 1 MiB, got 0.01", &fits),
              1)
        << e.what();
  }
  options.resolution = fits * 1.1;
  EXPECT_NO_THROW((void)polygonize(*ball(Vec3(0), 1.0), options));
}

TEST(Polygonize, RefusesWhatIsNoRegionOrResolution) {
  const FieldPtr field = ball(Vec3(0), 1.0);
  EXPECT_THROW((void)polygonize(*field, {}), ParameterError);
  EXPECT_THROW((void)polygonize(*field, cube(1.0, 0.0)), ParameterError);
  EXPECT_THROW((void)polygonize(*field, cube(1.0, std::nan(""))), ParameterError);
  EXPECT_THROW((void)polygonize(*field, cube(1e9, 0.1)), ParameterError);
  EXPECT_THROW((void)polygonize(*field, cube(-1.0, 0.1)), ParameterError);
}

TEST(Polygonize, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW((void)polygonize(*ball(Vec3(0), 1.0), cube(1.2, 0.1), {.stop = source.get_token()}), Cancelled);
}

/// Answers 1 everywhere outside the box it was narrowed to, and shows that its bound lies.
class LyingField final : public PointField {
 public:
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    return box.half_diagonal() < 1.0 && box.centre().x > 0.0 ? Interval{1.0, 2.0} : Interval{-1.0, 1.0};
  }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override { return glm::length(p) - 1.0; }
};

TEST(Polygonize, TellsOfAFieldWhoseBoundLies) {
  EXPECT_THROW((void)polygonize(*std::make_shared<LyingField>(), cube(1.6, 0.1, Border::Open)), ParameterError);
}

}  // namespace
}  // namespace outcrop

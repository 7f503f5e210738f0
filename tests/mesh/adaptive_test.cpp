/// Bricks of different sizes side by side: one closed surface, whatever the levels.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "fields.h"
#include "mesh_region.h"
#include "outcrop/core/parallel.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"
#include "self_intersections.h"

namespace outcrop {
namespace {

using meshing::BrickPlace;
using test::ball;
using test::formula;
using test::waves;

PolygonizeOptions cube(double half, double resolution, double tolerance) {
  return {.region = {Vec3(-half), Vec3(half)},
          .resolution = resolution,
          .tolerance = tolerance,
          .border = Border::Closed,
          .keep_voids = true};
}

void expect_solid(const TriangleMesh& mesh, const std::string& what) {
  const MeshCheck check = check_mesh(mesh);
  EXPECT_GT(check.triangles, 0u) << what;
  EXPECT_EQ(check.open_edges, 0u) << what;
  EXPECT_EQ(check.nonmanifold_edges, 0u) << what;
  EXPECT_EQ(check.nonmanifold_vertices, 0u) << what;
  EXPECT_EQ(check.degenerate_triangles, 0u) << what;
  EXPECT_GT(check.volume, 0.0) << what;
}

/// Splits bricks at random: small and large ones anywhere, as far as balance lets them.
meshing::ForcedSplits random_splits(Seed seed, double share) {
  return [=](const BrickPlace& at) {
    const auto key = static_cast<std::uint64_t>(at.index.x + 1024 * (at.index.y + 1024 * at.index.z) + (at.level << 30));
    return Rng(seed, "split", key).uniform() < share;
  };
}

struct Meshed {
  TriangleMesh mesh;
  PolygonizeStatistics statistics;
};

Meshed mesh_with(const Field& field, const PolygonizeOptions& options, const meshing::ForcedSplits& splits) {
  meshing::MeshCollector collector;
  MeshSink* const sinks[] = {&collector};
  Meshed result;
  result.statistics =
      meshing::mesh_region(field, meshing::Lattice::over(options), options, {}, sinks, {}, splits);
  result.mesh = collector.take();
  return result;
}

int levels_used(const PolygonizeStatistics& statistics) {
  int used = 0;
  for (const std::size_t bricks : statistics.bricks) used += bricks > 0;
  return used;
}

TEST(AdaptiveMesh, IsSolidAndFreeOfIntersectionsAtRandomLevels) {
  for (Seed seed = 0; seed < 6; ++seed) {
    const PolygonizeOptions options = cube(3.2, 0.05, 1.0);
    const FieldPtr field = waves(seed, 0.9 + 0.2 * static_cast<double>(seed), -0.05 + 0.02 * static_cast<double>(seed));
    const Meshed made = mesh_with(*field, options, random_splits(seed, 0.5));
    const std::string what = "seed " + std::to_string(seed);
    EXPECT_GE(levels_used(made.statistics), 3) << what;
    expect_solid(made.mesh, what);
    EXPECT_EQ(test::self_intersections(made.mesh), 0u) << what;
  }
}

}  // namespace
}  // namespace outcrop

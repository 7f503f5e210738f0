/// Meshes whose bricks are split where a test says so.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "mesh_region.h"
#include "outcrop/core/rng.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop::test {

inline void expect_solid(const TriangleMesh& mesh, const std::string& what) {
  const MeshCheck check = check_mesh(mesh);
  EXPECT_GT(check.triangles, 0u) << what;
  EXPECT_EQ(check.open_edges, 0u) << what;
  EXPECT_EQ(check.nonmanifold_edges, 0u) << what;
  EXPECT_EQ(check.nonmanifold_vertices, 0u) << what;
  EXPECT_EQ(check.degenerate_triangles, 0u) << what;
  EXPECT_GT(check.volume, 0.0) << what;
}

/// Splits bricks at random, the larger the likelier: small and large ones anywhere, as far as balance lets them.
inline meshing::ForcedSplits random_splits(Seed seed) {
  return [=](const meshing::BrickPlace& at) {
    const double share = 0.2 + 0.2 * at.level;
    const int cell = at.index.x + 1024 * (at.index.y + 1024 * at.index.z);
    const auto key = static_cast<std::uint64_t>(cell + (at.level << 30));
    return Rng(seed, "split", key).uniform() < share;
  };
}

struct Meshed {
  TriangleMesh mesh;
  PolygonizeStatistics statistics;
};

inline Meshed mesh_with(const Field& field, const PolygonizeOptions& options, const meshing::ForcedSplits& splits) {
  meshing::MeshCollector collector;
  MeshSink* const sinks[] = {&collector};
  Meshed result;
  const meshing::Lattice lattice = meshing::Lattice::over(options);
  meshing::Assembly assembly = meshing::mesh_region(field, lattice, options, {}, {}, splits);
  assembly.emit(sinks, {});
  result.statistics = assembly.statistics();
  result.mesh = collector.take();
  return result;
}

}  // namespace outcrop::test

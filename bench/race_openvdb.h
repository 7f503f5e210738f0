/// The same surface by OpenVDB: a narrow-band grid, then volumeToMesh.
#pragma once

#include <string>

#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop::race {

struct OpenVdbRun {
  TriangleMesh mesh;
  double fill_seconds = 0.0;  ///< CPU time of the process.
  double mesh_seconds = 0.0;
};

/// @param region      Cube whose edge is 8 · 2ⁿ voxels long; the surface lies inside.
/// @param resolution  Voxel edge, metres.
/// @param band        Voxels to each side of the surface that are filled at least, ≥ 1. OpenVDB's level sets have 3;
///                    for a mesh 1 is enough.
[[nodiscard]] OpenVdbRun mesh_by_openvdb(const Field& field, const Box& region, double resolution, int band);

[[nodiscard]] std::string openvdb_version();

}  // namespace outcrop::race

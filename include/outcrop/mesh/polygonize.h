/// From fields to triangle meshes.
#pragma once

#include <cstddef>

#include "outcrop/core/task.h"
#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop {

/// What closes the surface where the rock reaches the border of the region.
enum class Border {
  Open,    ///< The sheet ends at the border.
  Closed,  ///< Walls and a floor: the mesh bounds the rock inside the region.
};

/// Which connected parts are kept. Closed voids inside rock are always removed unless `keep_voids`.
enum class Parts {
  All,       ///< Every part.
  Grounded,  ///< Those whose rock reaches the region's floor (z lo): nothing floats.
  Largest,   ///< The part with the largest volume.
};

struct PolygonizeOptions {
  Box region;                ///< World, finite, not empty. Its lattice starts at lo; hi is moved out to whole cells.
  double resolution = 0.25;  ///< Cell edge in metres, > 0.
  Border border = Border::Open;
  Parts parts = Parts::All;
  bool keep_voids = false;
  bool normals = true;
  bool labels = true;
  std::size_t memory_limit =
      0;  ///< Bytes; 0: none. Exceeding it is a ParameterError that says which resolution would fit.
};

struct PolygonizeStatistics {
  std::size_t cells = 0;          ///< Cells that the surface crosses.
  std::size_t evaluations = 0;    ///< Field values computed.
  std::size_t parts_removed = 0;  ///< Floating parts.
  std::size_t voids_removed = 0;
};

struct PolygonizeResult {
  TriangleMesh mesh;
  PolygonizeStatistics statistics;
};

/// The zero surface of `field` in a region: closed but for the region's border (Border::Open), manifold, oriented
/// outwards.
///
/// Marching cubes on one integer lattice with searched tables, over bricks of 8³ cells that `bound` cannot exclude and
/// in which the field is narrowed. Vertices lie on the surface to within resolution / 1000 where f is smooth, and to
/// within resolution / 50 where it passes that close to a node of the lattice, so that no triangle degenerates. The
/// mesh's origin is region.lo. The same bytes for any number of threads. Cost: O(cells crossed) evaluations; memory
/// O(triangles).
/// @throws ParameterError also when the field's bound or narrow contradict its values; Cancelled.
[[nodiscard]] PolygonizeResult polygonize(const Field& field, const PolygonizeOptions& options, const Task& task = {});

/// Surface cells, triangles and bytes to expect, from bounds and about a thousand sampled bricks: within some 15 %. For
/// --dry-run and memory limits.
struct PolygonizeEstimate {
  std::size_t cells = 0, triangles = 0, bytes = 0;
};
[[nodiscard]] PolygonizeEstimate estimate_polygonize(const Field& field, const PolygonizeOptions& options,
                                                     const Task& task = {});

}  // namespace outcrop

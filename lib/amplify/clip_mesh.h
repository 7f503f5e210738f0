/// Cutting a sheet of triangles along the zero line of a field.
#pragma once

#include "outcrop/implicit/field.h"
#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop {

/// The part of the mesh where `field` < 0: triangles across its zero line are cut along it, so that the rim is smooth.
/// Neighbours share the cut's vertices. Vertices that nobody uses any more are left out. Cost: linear.
[[nodiscard]] TriangleMesh clip_mesh(const TriangleMesh& mesh, const Field& field);

/// A mesh that polygonize() made with Border::Closed without the walls at the region's border: what it makes with
/// Border::Open, to the byte.
/// @param extent  PolygonizeStatistics::extent.
[[nodiscard]] TriangleMesh without_walls(const TriangleMesh& mesh, const Box& extent);

}  // namespace outcrop

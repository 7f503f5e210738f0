/// Walls, floor and lid: what closes a sheet at the region's sides.
#pragma once

#include <cstdint>
#include <vector>

#include "lattice.h"
#include "outcrop/core/task.h"
#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop::meshing {

/// Sides of the lattice that a vertex lies on, to the bit: bit 2 · axis, plus 1 for the far side.
[[nodiscard]] unsigned sides_of(const Lattice& lattice, const Vec3f& position) noexcept;
inline constexpr unsigned kFloorSide = 1u << 4;

/// The sheet with the rock on the lattice's six sides filled by flat triangles, appended after the sheet's own.
///
/// Their corners are the sheet's border vertices and the lattice's corners that are rock; no others, so two walls share
/// their edge. Corners carry the mean normal of their three sides and the label of the field there.
[[nodiscard]] TriangleMesh close_sheet(TriangleMesh sheet, const Field& field, const Lattice& lattice,
                                       const PolygonizeOptions& options, const Task& task);

}  // namespace outcrop::meshing

/// Walls, floor and lid: what closes a sheet at the region's sides.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "lattice.h"
#include "outcrop/core/task.h"

namespace outcrop::meshing {

/// Sides of the lattice that a vertex lies on, to the bit: bit 2 · axis, plus 1 for the far side.
[[nodiscard]] unsigned sides_of(const Lattice& lattice, const Vec3f& position) noexcept;
inline constexpr unsigned kFloorSide = 1u << 4;

/// Where a sheet ends: its vertices on the lattice's sides, and its edges in each side, as the sheet's triangles run.
struct SideCurves {
  using Segment = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Vec3f> vertices;
  std::array<std::vector<Segment>, 6> segments;
};

/// The rock on the lattice's six sides as flat triangles.
///
/// Their corners are the sheet's vertices there and the lattice's corners that are rock; no others, so two walls share
/// their edge. Corners carry the mean normal of their three sides and the label of the field there.
struct Walls {
  std::vector<Vec3f> corners, normals;
  std::vector<Label> labels;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Of the curves' vertices, then `corners`.
};
[[nodiscard]] Walls make_walls(SideCurves curves, const Field& field, const Lattice& lattice,
                               const PolygonizeOptions& options, const Task& task);

}  // namespace outcrop::meshing

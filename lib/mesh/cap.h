/// Flat areas between closed polygons, as triangles; the only door to CGAL in this stage.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "outcrop/core/vec.h"

namespace outcrop::meshing {

/// Triangulates the area that an odd number of the closed curves made by `edges` surrounds, with `points` as its only
/// corners: counter-clockwise, constrained Delaunay, edges and diagonals never twice in one direction.
///
/// @param points  Distinct. @param edges  Pairs of points that meet nowhere but at points; every point of the curves
/// lies on an even number of them. Cost: O(n log n).
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> fill_curves(
    std::span<const Vec2> points, std::span<const std::pair<std::uint32_t, std::uint32_t>> edges);

}  // namespace outcrop::meshing

/// Convex hulls of points, by CGAL.
#pragma once

#include <optional>
#include <span>

#include "outcrop/fracture/tile.h"

namespace outcrop {

/// The convex hull as triangles, counter-clockwise from outside; nothing when all points lie in a plane, to 1e-9 of
/// their extent, or are fewer than four. Cost: O(n log n) expected. Method: quickhull with exact predicates @cite cgal.
[[nodiscard]] std::optional<BlockMesh> convex_hull(std::span<const Vec3> points);

/// The same for any points, one at least: a point, a line or a flat set is thickened to a cube, a bar or a plate of
/// `thickness` metres, as Paris et al. 2020, section 4.2 ask for.
/// @throws ParameterError without points or for a thickness ≤ 0.
[[nodiscard]] BlockMesh thick_hull(std::span<const Vec3> points, double thickness);

/// The volume inside a closed mesh, m³.
[[nodiscard]] double volume(const BlockMesh& mesh) noexcept;

}  // namespace outcrop

#include "border.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "cap.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"

namespace outcrop::meshing {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
using Segment = SideCurves::Segment;

unsigned side_bit(int axis, int end) { return 1u << (2 * axis + end); }

/// Adds the lattice's corners that are rock. @return for each corner x + 2y + 4z its vertex or kNone.
std::array<std::uint32_t, 8> add_corners(std::vector<Vec3f>& vertices, Walls& walls, const Field& field,
                                         const Lattice& lattice, const PolygonizeOptions& options) {
  std::array<std::uint32_t, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const IVec3 far(i & 1, i >> 1 & 1, i >> 2 & 1), index = far * lattice.cells;
    const Vec3 p = lattice.node(index);
    corners[i] = kNone;
    if (!(field.value(p) < 0.0)) continue;
    corners[i] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(lattice.local(Vec3(index)));
    walls.corners.push_back(vertices.back());
    if (options.normals) walls.normals.push_back(glm::normalize(Vec3f(2 * far - 1)));
    if (options.labels) {
      Label label = 0;
      field.labels({{&p.x, 1}, {&p.y, 1}, {&p.z, 1}}, {&label, 1});
      walls.labels.push_back(label);
    }
  }
  return corners;
}

/// The lattice's twelve edges: cuts them at the sheet and appends the pieces in rock to the two sides that meet there.
/// @param sides  Of the sheet's vertices alone.
void add_box_edges(SideCurves& curves, const std::vector<unsigned>& sides,
                   const std::array<std::uint32_t, 8>& corners) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int place = 0; place < 4; ++place) {
      const int end_u = place & 1, end_v = place >> 1;
      const unsigned both = side_bit(u, end_u) | side_bit(v, end_v);
      std::vector<std::uint32_t> cuts;
      for (std::uint32_t i = 0; i < sides.size(); ++i)
        if ((sides[i] & both) == both) cuts.push_back(i);
      std::sort(cuts.begin(), cuts.end(), [&](std::uint32_t a, std::uint32_t b) {
        return curves.vertices[a][axis] < curves.vertices[b][axis];
      });
      const int first_corner = (end_u << u) | (end_v << v);
      if (corners[first_corner] != kNone) cuts.insert(cuts.begin(), corners[first_corner]);
      if (corners[first_corner | 1 << axis] != kNone) cuts.push_back(corners[first_corner | 1 << axis]);
      require(cuts.size() % 2 == 0, "field", "bound and narrow that agree with its values",
              "a surface that leaves the region and does not return");
      for (std::size_t i = 0; i < cuts.size(); i += 2) {
        curves.segments[2 * u + end_u].emplace_back(cuts[i], cuts[i + 1]);
        curves.segments[2 * v + end_v].emplace_back(cuts[i], cuts[i + 1]);
      }
    }
  }
}

/// The triangles of one side, facing outwards.
std::vector<std::array<std::uint32_t, 3>> fill_side(const std::vector<Vec3f>& vertices, int side,
                                                    const std::vector<Segment>& segments) {
  if (segments.empty()) return {};
  const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<std::uint32_t> used;
  for (const Segment& s : segments) {
    used.push_back(s.first);
    used.push_back(s.second);
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto number = [&](std::uint32_t vertex) {
    return static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), vertex) - used.begin());
  };
  std::vector<Vec2> points;
  for (const std::uint32_t vertex : used) points.emplace_back(vertices[vertex][u], vertices[vertex][v]);
  std::vector<Segment> edges;
  for (const Segment& s : segments) edges.emplace_back(number(s.first), number(s.second));
  auto triangles = fill_curves(points, edges);
  for (auto& t : triangles) {
    // Counter-clockwise in (u, v) faces along +axis.
    if (side % 2 == 0) std::swap(t[1], t[2]);
    for (std::uint32_t& vertex : t) vertex = used[vertex];
  }
  return triangles;
}

}  // namespace

unsigned sides_of(const Lattice& lattice, const Vec3f& position) noexcept {
  unsigned sides = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (position[axis] == lattice.local(axis, 0)) sides |= side_bit(axis, 0);
    if (position[axis] == lattice.local(axis, lattice.cells[axis])) sides |= side_bit(axis, 1);
  }
  return sides;
}

Walls make_walls(SideCurves curves, const Field& field, const Lattice& lattice, const PolygonizeOptions& options,
                 const Task& task) {
  Walls walls;
  std::vector<unsigned> sides;
  for (const Vec3f& p : curves.vertices) sides.push_back(sides_of(lattice, p));
  const auto corners = add_corners(curves.vertices, walls, field, lattice, options);
  add_box_edges(curves, sides, corners);
  const auto filled = parallel_map(
      6, [&](std::size_t i) { return fill_side(curves.vertices, static_cast<int>(i), curves.segments[i]); }, task);
  for (const auto& side : filled) walls.triangles.insert(walls.triangles.end(), side.begin(), side.end());
  return walls;
}

}  // namespace outcrop::meshing

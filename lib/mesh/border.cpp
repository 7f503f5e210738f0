#include "border.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "cap.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"

namespace outcrop::meshing {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
using Segment = std::pair<std::uint32_t, std::uint32_t>;

unsigned side_bit(int axis, int end) { return 1u << (2 * axis + end); }

/// Adds the lattice's corners that are rock as vertices. @return for each corner x + 2y + 4z its vertex or kNone.
std::array<std::uint32_t, 8> add_corners(TriangleMesh& mesh, const Field& field, const Lattice& lattice,
                                         const PolygonizeOptions& options) {
  std::array<std::uint32_t, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const IVec3 far(i & 1, i >> 1 & 1, i >> 2 & 1), index = far * lattice.cells;
    const Vec3 p = lattice.node(index);
    corners[i] = kNone;
    if (!(field.value(p) < 0.0)) continue;
    corners[i] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.emplace_back(lattice.local(index.x), lattice.local(index.y), lattice.local(index.z));
    if (options.normals) mesh.normals.push_back(glm::normalize(Vec3f(2 * far - 1)));
    if (options.labels) {
      Label label = 0;
      field.labels({{&p.x, 1}, {&p.y, 1}, {&p.z, 1}}, {&label, 1});
      mesh.labels.push_back(label);
    }
  }
  return corners;
}

/// The lattice's twelve edges: cuts them at the sheet and appends the pieces in rock to the two sides that meet there.
void add_box_edges(const TriangleMesh& mesh, const std::vector<unsigned>& sides,
                   const std::vector<std::uint32_t>& border, const std::array<std::uint32_t, 8>& corners,
                   std::array<std::vector<Segment>, 6>& segments) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int place = 0; place < 4; ++place) {
      const int end_u = place & 1, end_v = place >> 1;
      const unsigned both = side_bit(u, end_u) | side_bit(v, end_v);
      std::vector<std::uint32_t> cuts;
      for (std::size_t i = 0; i < border.size(); ++i)
        if ((sides[i] & both) == both) cuts.push_back(border[i]);
      std::sort(cuts.begin(), cuts.end(),
                [&](std::uint32_t a, std::uint32_t b) { return mesh.positions[a][axis] < mesh.positions[b][axis]; });
      const int first_corner = (end_u << u) | (end_v << v);
      if (corners[first_corner] != kNone) cuts.insert(cuts.begin(), corners[first_corner]);
      if (corners[first_corner | 1 << axis] != kNone) cuts.push_back(corners[first_corner | 1 << axis]);
      require(cuts.size() % 2 == 0, "field", "bound and narrow that agree with its values",
              "a surface that leaves the region and does not return");
      for (std::size_t i = 0; i < cuts.size(); i += 2) {
        segments[2 * u + end_u].emplace_back(cuts[i], cuts[i + 1]);
        segments[2 * v + end_v].emplace_back(cuts[i], cuts[i + 1]);
      }
    }
  }
}

/// The triangles of one side, facing outwards.
std::vector<std::array<std::uint32_t, 3>> fill_side(const TriangleMesh& mesh, int side,
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
  for (const std::uint32_t vertex : used) points.emplace_back(mesh.positions[vertex][u], mesh.positions[vertex][v]);
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
    if (position[axis] == 0.0f) sides |= side_bit(axis, 0);
    if (position[axis] == lattice.local(lattice.cells[axis])) sides |= side_bit(axis, 1);
  }
  return sides;
}

TriangleMesh close_sheet(TriangleMesh mesh, const Field& field, const Lattice& lattice,
                         const PolygonizeOptions& options, const Task& task) {
  std::vector<std::uint32_t> border;
  std::vector<unsigned> sides;
  std::array<std::vector<Segment>, 6> segments;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const unsigned s = sides_of(lattice, mesh.positions[v]);
    if (s == 0) continue;
    border.push_back(v);
    sides.push_back(s);
  }
  // No diagonal of a cell lies in a face of it: a triangle's edge that lies in a side of the lattice ends the sheet.
  const auto on_sides = [&](std::uint32_t v) { return sides_of(lattice, mesh.positions[v]); };
  for (const auto& t : mesh.triangles) {
    const unsigned s[3] = {on_sides(t[0]), on_sides(t[1]), on_sides(t[2])};
    for (int i = 0; i < 3; ++i) {
      const unsigned shared = s[i] & s[(i + 1) % 3];
      if (shared != 0) segments[std::countr_zero(shared)].emplace_back(t[i], t[(i + 1) % 3]);
    }
  }
  task.check();
  const auto corners = add_corners(mesh, field, lattice, options);
  add_box_edges(mesh, sides, border, corners, segments);
  const auto walls = parallel_map(
      6, [&](std::size_t i) { return fill_side(mesh, static_cast<int>(i), segments[i]); }, task);
  for (const auto& wall : walls) mesh.triangles.insert(mesh.triangles.end(), wall.begin(), wall.end());
  return mesh;
}

}  // namespace outcrop::meshing

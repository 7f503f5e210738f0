#include "outcrop/fracture/hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <cmath>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

constexpr std::uint32_t kUnused = ~0u;
constexpr double kFlat = 1e-9;  // Of the extent: thinner sets have no inside.

// Whether the points span space: a base point, the one farthest from it, from their line, from their plane.
bool spans_space(std::span<const Vec3> points) {
  if (points.size() < 4) return false;
  const auto farthest = [&](auto&& measure) {
    double most = 0.0;
    Vec3 best = points[0];
    for (const Vec3& p : points)
      if (const double m = measure(p); m > most) {
        most = m;
        best = p;
      }
    return std::pair(most, best);
  };
  const Vec3 base = points[0];
  const auto [extent, far] = farthest([&](const Vec3& p) { return glm::length(p - base); });
  if (extent == 0.0) return false;
  const Vec3 line = (far - base) / extent;
  const auto [width, aside] = farthest([&](const Vec3& p) { return glm::length(glm::cross(line, p - base)); });
  if (width <= kFlat * extent) return false;
  const Vec3 normal = glm::normalize(glm::cross(line, aside - base));
  const auto [height, above] = farthest([&](const Vec3& p) { return std::abs(glm::dot(normal, p - base)); });
  return height > kFlat * extent;
}

Vec3 as_vec(const Point& p) { return {p.x(), p.y(), p.z()}; }

bool before(const Vec3& a, const Vec3& b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

// The vertices around each face, triangles that lie exactly in one plane taken together.
std::vector<std::vector<std::uint32_t>> flat_faces(const Mesh& hull) {
  const auto is_inner = [&](Mesh::Halfedge_index h) {
    return CGAL::coplanar(hull.point(hull.source(h)), hull.point(hull.target(h)), hull.point(hull.target(hull.next(h))),
                          hull.point(hull.target(hull.next(hull.opposite(h)))));
  };
  std::vector<bool> done(hull.num_halfedges(), false);
  std::vector<std::vector<std::uint32_t>> loops;
  for (const auto start : hull.halfedges()) {
    if (done[start] || is_inner(start)) continue;
    loops.emplace_back();
    auto h = start;
    do {  // along the border of the face, turning around each of its vertices past the inner edges
      done[h] = true;
      loops.back().push_back(static_cast<std::uint32_t>(hull.source(h)));
      h = hull.next(h);
      while (is_inner(h)) h = hull.next(hull.opposite(h));
    } while (h != start);
  }
  return loops;
}

}  // namespace

std::optional<BlockMesh> convex_hull(std::span<const Vec3> points) {
  if (!spans_space(points)) return std::nullopt;
  std::vector<Point> input;
  input.reserve(points.size());
  for (const Vec3& p : points) input.emplace_back(p.x, p.y, p.z);
  Mesh hull;
  CGAL::convex_hull_3(input.begin(), input.end(), hull);

  // CGAL's order of vertices and facets, and its triangles within a flat face, follow memory addresses. Ours must not:
  // vertices in the order of the input, faces as fans from their first vertex, sorted.
  std::vector<std::pair<Vec3, std::size_t>> on_hull;
  for (const auto v : hull.vertices()) on_hull.emplace_back(as_vec(hull.point(v)), v);
  std::sort(on_hull.begin(), on_hull.end(), [](const auto& a, const auto& b) { return before(a.first, b.first); });
  BlockMesh mesh;
  std::vector<std::uint32_t> index(hull.num_vertices(), kUnused);
  for (const Vec3& p : points) {
    const auto found = std::lower_bound(on_hull.begin(), on_hull.end(), p,
                                        [](const auto& a, const Vec3& q) { return before(a.first, q); });
    if (found == on_hull.end() || found->first != p || index[found->second] != kUnused) continue;
    index[found->second] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(p);
  }
  for (std::vector<std::uint32_t> loop : flat_faces(hull)) {
    for (std::uint32_t& v : loop) v = index[v];
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    for (std::size_t i = 2; i < loop.size(); ++i) mesh.triangles.push_back({loop[0], loop[i - 1], loop[i]});
  }
  std::sort(mesh.triangles.begin(), mesh.triangles.end());
  return mesh;
}

BlockMesh thick_hull(std::span<const Vec3> points, double thickness) {
  require(!points.empty(), "points", "at least one", 0.0);
  require(thickness > 0.0, "thickness", "> 0", thickness);
  if (auto hull = convex_hull(points)) return *std::move(hull);
  std::vector<Vec3> corners;
  for (const Vec3& p : points)
    for (int corner = 0; corner < 8; ++corner)
      corners.push_back(p + 0.5 * thickness * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  return convex_hull(corners).value();
}

double volume(const BlockMesh& mesh) noexcept {
  if (mesh.vertices.empty()) return 0.0;
  const Vec3 o = mesh.vertices[0];
  double six = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += glm::dot(mesh.vertices[a] - o, glm::cross(mesh.vertices[b] - o, mesh.vertices[c] - o));
  return six / 6.0;
}

}  // namespace outcrop

#include "outcrop/fracture/hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <cmath>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

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

}  // namespace

std::optional<BlockMesh> convex_hull(std::span<const Vec3> points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  if (!spans_space(points)) return std::nullopt;
  std::vector<Kernel::Point_3> input;
  input.reserve(points.size());
  for (const Vec3& p : points) input.emplace_back(p.x, p.y, p.z);
  Mesh hull;
  CGAL::convex_hull_3(input.begin(), input.end(), hull);

  BlockMesh mesh;
  std::vector<std::uint32_t> index(hull.num_vertices());
  for (const auto v : hull.vertices()) {
    const Kernel::Point_3& p = hull.point(v);
    index[v] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto face : hull.faces()) {
    std::vector<std::uint32_t> loop;
    for (const auto v : hull.vertices_around_face(hull.halfedge(face))) loop.push_back(index[v]);
    for (std::size_t i = 2; i < loop.size(); ++i) mesh.triangles.push_back({loop[0], loop[i - 1], loop[i]});
  }
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

#include "clip_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include <glm/geometric.hpp>

namespace outcrop {
namespace {

constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
constexpr double kOnSide = 1e-7;   // Of the extent, a float's rounding: the surface keeps a fiftieth of a cell away from nodes.
constexpr double kNearest = 0.02;  // Of an edge: cuts keep away from its ends, so that no sliver appears.

std::vector<double> values_at_vertices(const TriangleMesh& mesh, const Field& field) {
  std::vector<double> x, y, z;
  for (const Vec3f& p : mesh.positions) {
    x.push_back(mesh.origin.x + p.x);
    y.push_back(mesh.origin.y + p.y);
    z.push_back(mesh.origin.z + p.z);
  }
  std::vector<double> values(x.size());
  field.values({x, y, z}, values, {});
  return values;
}

class Clipper {
 public:
  Clipper(const TriangleMesh& mesh, std::vector<double> values)
      : mesh_(mesh), values_(std::move(values)), kept_(mesh.positions.size(), kUnused) {
    result_.origin = mesh.origin;
  }

  TriangleMesh operator()() {
    for (const auto& triangle : mesh_.triangles) clip(triangle);
    return std::move(result_);
  }

 private:
  void clip(const std::array<std::uint32_t, 3>& triangle) {
    std::array<std::uint32_t, 4> polygon{};
    std::size_t corners = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
      if (values_[a] < 0.0) polygon[corners++] = keep(a);
      if ((values_[a] < 0.0) != (values_[b] < 0.0)) polygon[corners++] = cut(a, b);
    }
    for (std::size_t i = 2; i < corners; ++i) result_.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }

  std::uint32_t keep(std::uint32_t vertex) {
    if (kept_[vertex] == kUnused) kept_[vertex] = add(vertex, vertex, 0.0);
    return kept_[vertex];
  }

  std::uint32_t cut(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);  // Both triangles at the edge compute the same vertex.
    const std::uint64_t edge = (static_cast<std::uint64_t>(a) << 32) | b;
    if (const auto found = cuts_.find(edge); found != cuts_.end()) return found->second;
    const double t = std::clamp(values_[a] / (values_[a] - values_[b]), kNearest, 1.0 - kNearest);
    return cuts_[edge] = add(a, b, t);
  }

  std::uint32_t add(std::uint32_t a, std::uint32_t b, double t) {
    const float s = static_cast<float>(t);
    result_.positions.push_back((1.0f - s) * mesh_.positions[a] + s * mesh_.positions[b]);
    if (!mesh_.normals.empty())
      result_.normals.push_back(a == b ? mesh_.normals[a]
                                       : glm::normalize((1.0f - s) * mesh_.normals[a] + s * mesh_.normals[b]));
    if (!mesh_.labels.empty()) result_.labels.push_back(mesh_.labels[t < 0.5 ? a : b]);
    return static_cast<std::uint32_t>(result_.positions.size() - 1);
  }

  const TriangleMesh& mesh_;
  std::vector<double> values_;
  std::vector<std::uint32_t> kept_;
  std::unordered_map<std::uint64_t, std::uint32_t> cuts_;
  TriangleMesh result_;
};

/// The sides of a box that a point lies on, a bit each.
unsigned sides_of(const Vec3f& p, const Box& box) {
  unsigned sides = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = kOnSide * std::max(std::abs(box.lo[axis]), std::abs(box.hi[axis]));
    if (p[axis] < box.lo[axis] + slack) sides |= 1u << (2 * axis);
    if (p[axis] > box.hi[axis] - slack) sides |= 2u << (2 * axis);
  }
  return sides;
}

}  // namespace

TriangleMesh without_walls(const TriangleMesh& mesh, const Box& extent) {
  const Box box = extent.moved(-mesh.origin);
  std::vector<std::uint32_t> kept(mesh.positions.size(), kUnused);
  TriangleMesh result;
  result.origin = mesh.origin;
  for (const auto& t : mesh.triangles) {
    const auto& p = mesh.positions;
    if ((sides_of(p[t[0]], box) & sides_of(p[t[1]], box) & sides_of(p[t[2]], box)) != 0) continue;
    result.triangles.push_back(t);
    for (const std::uint32_t v : t) kept[v] = 0;
  }
  for (std::size_t v = 0; v < kept.size(); ++v) {
    if (kept[v] == kUnused) continue;
    kept[v] = static_cast<std::uint32_t>(result.positions.size());
    result.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[v]);
    if (!mesh.labels.empty()) result.labels.push_back(mesh.labels[v]);
  }
  for (auto& t : result.triangles)
    for (std::uint32_t& v : t) v = kept[v];
  return result;
}

TriangleMesh clip_mesh(const TriangleMesh& mesh, const Field& field) {
  return Clipper(mesh, values_at_vertices(mesh, field))();
}

}  // namespace outcrop

#include "outcrop/mesh/check_mesh.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "union_find.h"

namespace outcrop {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Flatter than this share of its longest side a triangle counts as degenerate: what doubles tell from zero.
constexpr double kFlat = 1e-12;

bool repeats_a_vertex(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// For each vertex a slice of `entries`; two passes, no sorting.
template <class Entry>
struct Incidence {
  std::vector<std::uint64_t> first;
  std::vector<Entry> entries;

  [[nodiscard]] std::span<Entry> of(std::size_t vertex) {
    return std::span(entries).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};

/// Groups what `each(emit)` emits as emit(vertex, entry).
template <class Entry, class Each>
Incidence<Entry> group(std::size_t vertices, Each&& each) {
  Incidence<Entry> result;
  result.first.assign(vertices + 1, 0);
  each([&](std::uint32_t vertex, const Entry&) { ++result.first[vertex + 1]; });
  for (std::size_t v = 0; v < vertices; ++v) result.first[v + 1] += result.first[v];
  result.entries.resize(result.first[vertices]);
  std::vector<std::uint64_t> next(result.first.begin(), result.first.end() - 1);
  each([&](std::uint32_t vertex, const Entry& entry) { result.entries[next[vertex]++] = entry; });
  return result;
}

/// A side as its vertex of lower number sees it: the other end, and whether it runs there or back.
struct Side {
  std::uint32_t other = 0;
  bool forward = false;
};

/// @return the number of edges.
std::size_t check_edges(const TriangleMesh& mesh, MeshCheck& check) {
  auto sides = group<Side>(mesh.positions.size(), [&](auto&& emit) {
    for (const Triangle& t : mesh.triangles) {
      if (repeats_a_vertex(t)) continue;
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i], b = t[(i + 1) % 3];
        emit(std::min(a, b), Side{std::max(a, b), a < b});
      }
    }
  });
  std::size_t edges = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const std::span<Side> own = sides.of(v);
    std::sort(own.begin(), own.end(), [](const Side& a, const Side& b) { return a.other < b.other; });
    for (std::size_t i = 0; i < own.size();) {
      std::size_t there = 0, back = 0;
      const std::uint32_t other = own[i].other;
      for (; i < own.size() && own[i].other == other; ++i) ++(own[i].forward ? there : back);
      ++edges;
      if (there == 0 || back == 0) ++check.open_edges;
      if (there > 1) ++check.nonmanifold_edges;
      if (back > 1) ++check.nonmanifold_edges;
    }
  }
  return edges;
}

/// Are the triangles around a vertex, given by their opposite sides, more than one fan?
bool has_many_fans(std::span<const std::pair<std::uint32_t, std::uint32_t>> opposite) {
  std::vector<std::uint32_t> ring;
  for (const auto& [a, b] : opposite) {
    ring.push_back(a);
    ring.push_back(b);
  }
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  const auto number = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::lower_bound(ring.begin(), ring.end(), v) - ring.begin());
  };
  meshing::UnionFind fans(ring.size());
  for (const auto& [a, b] : opposite) fans.join(number(a), number(b));
  for (std::uint32_t i = 0; i < ring.size(); ++i)
    if (fans.root(i) != 0) return true;
  return false;
}

void check_fans(const TriangleMesh& mesh, MeshCheck& check) {
  using Opposite = std::pair<std::uint32_t, std::uint32_t>;
  auto around = group<Opposite>(mesh.positions.size(), [&](auto&& emit) {
    for (const Triangle& t : mesh.triangles) {
      if (repeats_a_vertex(t)) continue;
      for (int i = 0; i < 3; ++i) emit(t[i], Opposite{t[(i + 1) % 3], t[(i + 2) % 3]});
    }
  });
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (has_many_fans(around.of(v))) ++check.nonmanifold_vertices;
}

void measure(const TriangleMesh& mesh, MeshCheck& check) {
  // Relative to a corner of the mesh, so that a mesh far from its origin keeps its digits.
  const Vec3 origin = mesh.positions.empty() ? Vec3(0.0) : Vec3(mesh.positions.front());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = Vec3(mesh.positions[t[0]]) - origin, b = Vec3(mesh.positions[t[1]]) - origin,
               c = Vec3(mesh.positions[t[2]]) - origin;
    const Vec3 normal = glm::cross(b - a, c - a);
    const double longest = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
    if (repeats_a_vertex(t) || !(glm::length(normal) > kFlat * longest)) ++check.degenerate_triangles;
    check.area += 0.5 * glm::length(normal);
    check.volume += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
}

}  // namespace

MeshCheck check_mesh(const TriangleMesh& mesh) {
  MeshCheck check;
  check.vertices = mesh.positions.size();
  check.triangles = mesh.triangles.size();
  const std::size_t edges = check_edges(mesh, check);
  check_fans(mesh, check);
  measure(mesh, check);

  meshing::UnionFind sets(mesh.positions.size());
  std::vector<char> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) used[v] = 1;
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  std::size_t used_vertices = 0;
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    ++used_vertices;
    if (sets.root(v) == v) ++check.parts;
  }
  check.euler = static_cast<long long>(used_vertices) - static_cast<long long>(edges) +
                static_cast<long long>(mesh.triangles.size());
  return check;
}

}  // namespace outcrop

#include "parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "border.h"
#include "union_find.h"

namespace outcrop::meshing {
namespace {

struct Part {
  std::uint32_t first_triangle = 0;
  double volume = 0.0;
  Box box;
  bool grounded = false;
  bool keep = true;
  std::vector<std::uint32_t> triangles;  ///< Filled for those that may surround others.

  [[nodiscard]] bool is_void() const { return volume <= 0.0; }
};

struct Labelling {
  std::vector<Part> parts;
  std::vector<std::uint32_t> part_of;  ///< One a triangle.
};

Labelling find_parts(const TriangleMesh& mesh, const Lattice& lattice) {
  UnionFind sets(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  Labelling result;
  result.part_of.resize(mesh.triangles.size());
  constexpr std::uint32_t kNew = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> part_of_root(mesh.positions.size(), kNew);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    std::uint32_t& part = part_of_root[sets.root(t[0])];
    if (part == kNew) {
      part = static_cast<std::uint32_t>(result.parts.size());
      result.parts.push_back({.first_triangle = i});
    }
    result.part_of[i] = part;
    Part& p = result.parts[part];
    // Relative to a point of the part: a small part far out keeps its digits.
    const Vec3 origin(mesh.positions[mesh.triangles[p.first_triangle][0]]);
    const Vec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    p.volume += glm::dot(a - origin, glm::cross(b - origin, c - origin)) / 6.0;
    for (const std::uint32_t v : t) {
      p.box.include(Vec3(mesh.positions[v]));
      if (sides_of(lattice, mesh.positions[v]) & kFloorSide) p.grounded = true;
    }
  }
  return result;
}

/// Is the point inside the closed surface? Solid angles add up to 4π or 0. Method: van Oosterom and Strackee 1983.
bool surrounds(const TriangleMesh& mesh, const Part& part, const Vec3& point) {
  double angle = 0.0;
  for (const std::uint32_t i : part.triangles) {
    const auto& t = mesh.triangles[i];
    const Vec3 a = Vec3(mesh.positions[t[0]]) - point, b = Vec3(mesh.positions[t[1]]) - point,
               c = Vec3(mesh.positions[t[2]]) - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    angle += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                              la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return std::abs(angle) > 2.0 * kPi;
}

/// Drops the parts `inners` that one of `outers` surrounds.
void drop_surrounded(const TriangleMesh& mesh, Labelling& labelling, const std::vector<std::uint32_t>& outers,
                     std::vector<std::uint32_t> inners) {
  std::vector<Part>& parts = labelling.parts;
  const auto lo_x = [&](std::uint32_t part) { return parts[part].box.lo.x; };
  std::sort(inners.begin(), inners.end(), [&](std::uint32_t a, std::uint32_t b) { return lo_x(a) < lo_x(b); });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<char> wanted(parts.size(), 0);
  for (const std::uint32_t outer : outers) {
    const Box& box = parts[outer].box;
    auto it = std::lower_bound(inners.begin(), inners.end(), box.lo.x,
                               [&](std::uint32_t p, double x) { return lo_x(p) < x; });
    for (; it != inners.end() && lo_x(*it) <= box.hi.x; ++it) {
      if (!box.contains(parts[*it].box.lo) || !box.contains(parts[*it].box.hi)) continue;
      pairs.emplace_back(outer, *it);
      wanted[outer] = 1;
    }
  }
  if (pairs.empty()) return;
  for (std::uint32_t t = 0; t < labelling.part_of.size(); ++t)
    if (wanted[labelling.part_of[t]]) parts[labelling.part_of[t]].triangles.push_back(t);
  for (const auto& [outer, inner] : pairs) {
    const Vec3 point(mesh.positions[mesh.triangles[parts[inner].first_triangle][0]]);
    if (surrounds(mesh, parts[outer], point)) parts[inner].keep = false;
  }
}

void choose_rock(std::vector<Part>& parts, Parts wanted) {
  if (wanted == Parts::All) return;
  std::optional<std::size_t> largest;
  bool any_grounded = false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].is_void()) continue;
    if (!largest || parts[i].volume > parts[*largest].volume) largest = i;
    any_grounded = any_grounded || parts[i].grounded;
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].is_void()) continue;
    parts[i].keep = wanted == Parts::Grounded && any_grounded ? parts[i].grounded : i == *largest;
  }
}

}  // namespace

PartSelection select_parts(const TriangleMesh& mesh, const Lattice& lattice, Parts wanted, bool keep_voids) {
  Labelling labelling = find_parts(mesh, lattice);
  std::vector<Part>& parts = labelling.parts;
  choose_rock(parts, wanted);
  std::vector<std::uint32_t> voids, kept_rock, removed_rock;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    if (parts[i].is_void()) parts[i].keep = keep_voids;
    (parts[i].is_void() ? voids : parts[i].keep ? kept_rock : removed_rock).push_back(i);
  }
  // A void goes with its rock, and rock with its void: what stays is never inside out and never inside other rock.
  if (keep_voids)
    drop_surrounded(mesh, labelling, removed_rock, std::move(voids));
  else
    drop_surrounded(mesh, labelling, voids, std::move(kept_rock));

  PartSelection selection;
  for (const Part& p : parts)
    if (!p.keep) ++(p.is_void() ? selection.voids_removed : selection.parts_removed);
  selection.keep.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < selection.keep.size(); ++t) selection.keep[t] = parts[labelling.part_of[t]].keep;
  return selection;
}

TriangleMesh filtered(TriangleMesh mesh, const std::vector<char>& keep) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> renamed(mesh.positions.size(), kUnused);
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!keep[i]) continue;
    for (const std::uint32_t v : mesh.triangles[i]) renamed[v] = 0;
    mesh.triangles[triangles++] = mesh.triangles[i];
  }
  mesh.triangles.resize(triangles);
  std::uint32_t vertices = 0;
  for (std::size_t v = 0; v < renamed.size(); ++v) {
    if (renamed[v] == kUnused) continue;
    renamed[v] = vertices;
    mesh.positions[vertices] = mesh.positions[v];
    if (!mesh.normals.empty()) mesh.normals[vertices] = mesh.normals[v];
    if (!mesh.labels.empty()) mesh.labels[vertices] = mesh.labels[v];
    ++vertices;
  }
  mesh.positions.resize(vertices);
  if (!mesh.normals.empty()) mesh.normals.resize(vertices);
  if (!mesh.labels.empty()) mesh.labels.resize(vertices);
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) v = renamed[v];
  return mesh;
}

}  // namespace outcrop::meshing

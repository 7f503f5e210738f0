#include "parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace outcrop::meshing {
namespace {

/// The solid angle of a triangle, seen from a point. Method: van Oosterom and Strackee 1983.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  return 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

}  // namespace

void Part::add_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) noexcept {
  const Vec3 u = Vec3(a) - origin, v = Vec3(b) - origin, w = Vec3(c) - origin;
  volume += glm::dot(u, glm::cross(v, w)) / 6.0;
  area += 0.5 * glm::cross(v - u, w - u);
}

void Part::merge(const Part& other) noexcept {
  // A third of the flux of (x − origin): moving the origin by s takes a third of s · area away.
  volume += other.volume - glm::dot(origin - other.origin, other.area) / 3.0;
  area += other.area;
  box = hull(box, other.box);
  vertices += other.vertices;
  triangles += other.triangles;
  grounded = grounded || other.grounded;
}

ChunkParts find_parts(const Chunk& chunk, const Lattice& lattice) {
  UnionFind sets(chunk.positions.size());
  for (const Triangle& t : chunk.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  ChunkParts result;
  result.part_of.resize(chunk.positions.size());
  for (std::uint32_t v = 0; v < chunk.positions.size(); ++v) {
    const std::uint32_t root = sets.root(v);  // The set's smallest vertex.
    if (root == v) {
      result.part_of[v] = static_cast<std::uint32_t>(result.parts.size());
      result.parts.push_back({.origin = Vec3(chunk.positions[v])});
    } else {
      result.part_of[v] = result.part_of[root];
    }
    Part& part = result.parts[result.part_of[v]];
    ++part.vertices;
    part.box.include(Vec3(chunk.positions[v]));
    if (sides_of(lattice, chunk.positions[v]) & kFloorSide) part.grounded = true;
  }
  for (const Triangle& t : chunk.triangles) {
    Part& part = result.parts[result.part_of[t[0]]];
    ++part.triangles;
    part.add_triangle(chunk.positions[t[0]], chunk.positions[t[1]], chunk.positions[t[2]]);
  }
  return result;
}

PartList::PartNumber PartList::add(std::vector<Part> parts) {
  const auto first = static_cast<PartNumber>(parts_.size());
  parts_.insert(parts_.end(), parts.begin(), parts.end());
  sets_.resize(parts_.size());
  return first;
}

void PartList::choose_rock(const std::vector<PartNumber>& roots, Parts wanted) {
  if (wanted == Parts::All) return;
  std::optional<PartNumber> largest;
  bool any_grounded = false;
  for (const PartNumber i : roots) {
    if (parts_[i].is_void()) continue;
    if (!largest || parts_[i].volume > parts_[*largest].volume) largest = i;
    any_grounded = any_grounded || parts_[i].grounded;
  }
  for (const PartNumber i : roots) {
    if (parts_[i].is_void()) continue;
    parts_[i].keep = wanted == Parts::Grounded && any_grounded ? parts_[i].grounded : i == *largest;
  }
}

void PartList::drop_surrounded(const std::vector<PartNumber>& outers, std::vector<PartNumber> inners,
                               const std::function<void(const Visit&)>& for_each_triangle) {
  const auto lo_x = [&](PartNumber part) { return parts_[part].box.lo.x; };
  std::sort(inners.begin(), inners.end(), [&](PartNumber a, PartNumber b) { return lo_x(a) < lo_x(b); });
  struct Pair {
    PartNumber outer, inner;
    double angle = 0.0;
  };
  std::vector<Pair> pairs;  // Those of one outer part follow each other.
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> first_pair(parts_.size(), kNone);
  for (const PartNumber outer : outers) {
    const Box& box = parts_[outer].box;
    auto it = std::lower_bound(inners.begin(), inners.end(), box.lo.x,
                               [&](PartNumber p, double x) { return lo_x(p) < x; });
    for (; it != inners.end() && lo_x(*it) <= box.hi.x; ++it) {
      if (!box.contains(parts_[*it].box.lo) || !box.contains(parts_[*it].box.hi)) continue;
      if (first_pair[outer] == kNone) first_pair[outer] = static_cast<std::uint32_t>(pairs.size());
      pairs.push_back({outer, *it});
    }
  }
  if (pairs.empty()) return;
  for_each_triangle([&](PartNumber part, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const PartNumber outer = sets_.root(part);
    for (std::size_t i = first_pair[outer]; i < pairs.size() && pairs[i].outer == outer; ++i) {
      const Vec3& point = parts_[pairs[i].inner].origin;
      pairs[i].angle += solid_angle(Vec3(a) - point, Vec3(b) - point, Vec3(c) - point);
    }
  });
  // Inside a closed surface the angles add up to 4π, outside to 0.
  for (const Pair& pair : pairs)
    if (std::abs(pair.angle) > 2.0 * kPi) parts_[pair.inner].keep = false;
}

void PartList::choose(Parts wanted, bool keep_voids, const std::function<void(const Visit&)>& for_each_triangle) {
  std::vector<PartNumber> roots;
  for (PartNumber i = 0; i < parts_.size(); ++i) {
    const PartNumber root = sets_.root(i);
    if (root == i)
      roots.push_back(i);
    else
      parts_[root].merge(parts_[i]);
  }
  choose_rock(roots, wanted);
  std::vector<PartNumber> voids, kept_rock, removed_rock;
  for (const PartNumber i : roots) {
    if (parts_[i].is_void()) parts_[i].keep = keep_voids;
    (parts_[i].is_void() ? voids : parts_[i].keep ? kept_rock : removed_rock).push_back(i);
  }
  // A void goes with its rock, and rock with its void: what stays is never inside out and never inside other rock.
  if (keep_voids)
    drop_surrounded(removed_rock, std::move(voids), for_each_triangle);
  else
    drop_surrounded(voids, std::move(kept_rock), for_each_triangle);
  for (const PartNumber i : roots) {
    const Part& part = parts_[i];
    if (!part.keep) ++(part.is_void() ? voids_removed_ : parts_removed_);
    if (part.keep) {
      vertices_ += part.vertices;
      triangles_ += part.triangles;
    }
  }
}

}  // namespace outcrop::meshing

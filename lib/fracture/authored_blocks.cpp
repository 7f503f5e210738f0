#include "outcrop/fracture/authored_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "outcrop/fracture/hull.h"
#include "outcrop/fracture/joints.h"

namespace outcrop {
namespace {

constexpr double kSamePlane = 1.0 - 1.5e-8;  // Cosine of 0.01°.
constexpr double kTolerance = 1e-10;         // Of the side: as cells are cut.
constexpr double kLongest = 0.95;            // Of the side: as cells are.

Polytope intersection(Polytope a, const Polytope& b, double tolerance) {
  for (const Polytope::Face& face : b.faces) {
    if (a.empty()) break;
    a = clipped(a, face.plane, face.joint, tolerance);
  }
  return a;
}

bool overlap(const Polytope& a, const Polytope& b, double tolerance) {
  return a.bounds().overlaps(b.bounds()) && !intersection(a, b, tolerance).empty();
}

// What of a part none of the others holds.
std::vector<Polytope> beside(const Polytope& part, std::span<const Polytope> others, double tolerance) {
  std::vector<Polytope> pieces{part};
  for (const Polytope& other : others) {
    std::vector<Polytope> left;
    for (const Polytope& piece : pieces)
      std::ranges::move(difference(piece, other, tolerance), std::back_inserter(left));
    pieces = std::move(left);
  }
  return pieces;
}

Vec3 extent(const AuthoredBlock& block) {
  Box box;
  for (const Polytope& part : block.parts) box = hull(box, part.bounds());
  return box.size();
}

}  // namespace

Polytope hull_polytope(std::span<const Vec3> points) {
  const std::optional<BlockMesh> mesh = convex_hull(points);
  if (!mesh) return {};
  std::vector<Plane> planes;
  Box box;
  for (const Vec3& v : mesh->vertices) box.include(v);
  for (const auto& [a, b, c] : mesh->triangles) {
    const Vec3& o = mesh->vertices[a];
    const Vec3 normal = glm::cross(mesh->vertices[b] - o, mesh->vertices[c] - o);
    const double length = glm::length(normal);
    if (length == 0.0) continue;
    const Vec3 n = normal / length;
    const auto is_same = [&](const Plane& plane) { return glm::dot(plane.normal, n) > kSamePlane; };
    if (std::ranges::any_of(planes, is_same)) continue;
    double farthest = -1e300;
    for (const Vec3& v : mesh->vertices) farthest = std::max(farthest, glm::dot(n, v));
    planes.push_back({n, -farthest});
  }
  const double size = glm::length(box.size());
  Polytope result = box_polytope(box.grown(size));
  for (const Plane& plane : planes) result = clipped(result, plane, kAuthoredJoint, 1e-12 * size);
  return result;
}

std::vector<Polytope> difference(const Polytope& a, const Polytope& b, double tolerance) {
  if (!overlap(a, b, tolerance)) return {a};
  std::vector<Polytope> pieces;
  Polytope rest = a;
  for (const Polytope::Face& face : b.faces) {
    Polytope piece = clipped(rest, {-face.plane.normal, -face.plane.offset}, kAuthoredJoint, tolerance);
    if (piece.empty()) continue;
    pieces.push_back(std::move(piece));
    rest = clipped(rest, face.plane, kAuthoredJoint, tolerance);
    if (rest.empty()) break;
  }
  return pieces;
}

std::vector<CutCell> cut_around(const Polytope& cell, std::span<const Polytope> obstacles, double least_radius,
                                double tolerance) {
  std::vector<Polytope> parts{cell};
  for (const Polytope& obstacle : obstacles) {
    std::vector<Polytope> left;
    for (Polytope& part : parts) {
      if (!overlap(part, obstacle, tolerance)) {
        left.push_back(std::move(part));
        continue;
      }
      for (const Polytope::Face& face : obstacle.faces) {
        Polytope beyond = clipped(part, {-face.plane.normal, -face.plane.offset}, kAuthoredJoint, tolerance);
        if (!beyond.empty() && inscribed_ball(beyond).radius >= least_radius) left.push_back(std::move(beyond));
      }
    }
    parts = std::move(left);
  }
  // Large parts first: chips are covered by them, not the other way round.
  std::ranges::stable_sort(parts, std::ranges::greater{}, [](const Polytope& part) { return part.volume(); });
  const auto [kept, own] = without_covered(std::move(parts), tolerance);
  std::vector<std::size_t> piece_of(kept.size());
  std::iota(piece_of.begin(), piece_of.end(), std::size_t{0});
  for (std::size_t i = 0; i < kept.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (piece_of[i] != piece_of[j] && overlap(kept[i], kept[j], tolerance)) {
        const std::size_t from = std::max(piece_of[i], piece_of[j]);
        std::ranges::replace(piece_of, from, std::min(piece_of[i], piece_of[j]));
      }
  std::vector<CutCell> pieces;
  for (std::size_t first = 0; first < kept.size(); ++first) {
    CutCell piece;
    for (std::size_t i = first; i < kept.size(); ++i)
      if (piece_of[i] == first) {
        piece.parts.push_back(kept[i]);
        piece.volumes.push_back(own[i]);
      }
    if (!piece.parts.empty()) pieces.push_back(std::move(piece));
  }
  return pieces;
}

CutCell without_covered(std::vector<Polytope> parts, double tolerance) {
  CutCell result;
  for (Polytope& part : parts) {
    double volume = 0.0;
    for (const Polytope& piece : beside(part, result.parts, tolerance)) volume += piece.volume();
    const Vec3 size = part.bounds().size();
    if (volume <= tolerance * glm::dot(size, size)) continue;
    result.parts.push_back(std::move(part));
    result.volumes.push_back(volume);
  }
  return result;
}

std::vector<Polytope> welded(const std::vector<Polytope>& parts, double depth, double tolerance) {
  std::vector<Polytope> result = parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::vector<Polytope> others = parts;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    for (std::size_t f = 0; f < parts[i].faces.size(); ++f) {
      std::vector<Polytope::Face> faces = result[i].faces;
      faces[f].plane.offset -= depth;
      const Box box = result[i].bounds();
      Polytope longer = box_polytope(box.grown(depth + box.half_diagonal()));
      for (const Polytope::Face& face : faces) longer = clipped(longer, face.plane, face.joint, tolerance);
      if (longer.faces.size() != faces.size()) continue;  // It would end in a point.
      const std::vector<Polytope> added = difference(longer, result[i], tolerance);
      if (std::ranges::all_of(added, [&](const Polytope& piece) { return beside(piece, others, tolerance).empty(); }))
        result[i] = std::move(longer);
    }
  }
  return result;
}

Polytope grown(const Polytope& polytope, double distance, double tolerance) {
  const Box box = polytope.bounds();
  Polytope result = box_polytope(box.grown(distance + box.half_diagonal()));
  for (const Polytope::Face& face : polytope.faces)
    result = clipped(result, {face.plane.normal, face.plane.offset - distance}, face.joint, tolerance);
  return result;
}

Polytope moved(Polytope polytope, const Vec3& by) {
  for (Vec3& vertex : polytope.vertices) vertex += by;
  for (Polytope::Face& face : polytope.faces) face.plane.offset -= glm::dot(face.plane.normal, by);
  return polytope;
}

std::string misfit(std::span<const AuthoredBlock> blocks, double side) {
  const auto name = [](std::size_t i) { return "blocks[" + std::to_string(i) + "]"; };
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const AuthoredBlock& block = blocks[i];
    if (block.parts.empty() || std::ranges::any_of(block.parts, &Polytope::empty))
      return name(i) + ", which holds nothing";
    const Vec3 size = extent(block);
    if (std::max({size.x, size.y, size.z}) > kLongest * side)
      return name(i) + ", which is longer than 0.95 of the tile's side along x, y or z";
    for (std::size_t j = 0; j < i; ++j)
      for (const Polytope& a : block.parts)
        for (const Polytope& b : blocks[j].parts) {
          const Box box = a.bounds(), other = b.bounds();
          const Vec3 lo = glm::ceil((box.lo - other.hi) / side), hi = glm::floor((box.hi - other.lo) / side);
          for (double z = lo.z; z <= hi.z; ++z)
            for (double y = lo.y; y <= hi.y; ++y)
              for (double x = lo.x; x <= hi.x; ++x)
                if (overlap(a, moved(b, side * Vec3(x, y, z)), kTolerance * side))
                  return name(i) + ", which overlaps " + name(j) + " or a copy of it in the next tile";
        }
  }
  return {};
}

}  // namespace outcrop

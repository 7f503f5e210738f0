#include "outcrop/fracture/trace_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <tuple>

#include "outcrop/core/error.h"
#include "rock_cells.h"

namespace outcrop {
namespace {

constexpr double kSameDirection = 1e-7;  // Radians between faces of one joint; cuts keep planes to 1e-12.
constexpr double kSamePlace = 1e-7;      // Of the side.

/// An edge of a cell's section, on the line n · p = offset with n at `angle`.
struct Edge {
  int joint = kWall;
  double angle = 0.0, offset = 0.0;
  double lo = 0.0, hi = 0.0;  // Along the line.
};

// The part of the segment inside [0, width] × [0, height].
std::optional<std::pair<Vec2, Vec2>> cut_off(Vec2 a, Vec2 b, const Vec2& size) {
  double lo = 0.0;
  double hi = 1.0;
  const Vec2 d = b - a;
  for (int axis = 0; axis < 2; ++axis) {
    if (d[axis] == 0.0) {
      if (a[axis] < 0.0 || a[axis] > size[axis]) return std::nullopt;
      continue;
    }
    double t0 = -a[axis] / d[axis];
    double t1 = (size[axis] - a[axis]) / d[axis];
    if (t0 > t1) std::swap(t0, t1);
    lo = std::max(lo, t0);
    hi = std::min(hi, t1);
  }
  if (lo >= hi) return std::nullopt;
  return std::pair{a + lo * d, a + hi * d};
}

// Where a face's outline crosses the plane: two points, or nothing. A vertex on the plane counts as above it.
std::optional<std::pair<Vec3, Vec3>> section(const Polytope& shape, const Polytope::Face& face, const Plane& plane) {
  Vec3 ends[2];
  int found = 0;
  for (std::size_t i = 0; i < face.loop.size() && found < 2; ++i) {
    const Vec3& p = shape.vertices[face.loop[i]];
    const Vec3& q = shape.vertices[face.loop[(i + 1) % face.loop.size()]];
    const double s = plane.distance(p);
    const double t = plane.distance(q);
    if ((s < 0.0) != (t < 0.0)) ends[found++] = p + s / (s - t) * (q - p);
  }
  if (found < 2) return std::nullopt;
  return std::pair{ends[0], ends[1]};
}

// Edges of one joint along one line, in one piece, become traces.
void join(std::vector<Edge>& edges, double tolerance, const Tile& tile, std::vector<Trace>& traces) {
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.lo < b.lo; });
  for (std::size_t i = 0; i < edges.size();) {
    double hi = edges[i].hi;
    std::size_t j = i + 1;
    for (; j < edges.size() && edges[j].lo <= hi + tolerance; ++j) hi = std::max(hi, edges[j].hi);
    const Edge& first = edges[i];
    const Vec2 n(std::cos(first.angle), std::sin(first.angle));
    const Vec2 along(-n.y, n.x);
    traces.push_back(
        {first.offset * n + first.lo * along, first.offset * n + hi * along, first.joint, set_of(tile, first.joint)});
    i = j;
  }
}

// Calls `each` with runs of a sorted list in which neighbours differ by no more than `tolerance`.
template <class Key, class Each>
void runs(std::vector<Edge> edges, Key&& key, double tolerance, Each&& each) {
  std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i + 1;
    while (j < edges.size() && key(edges[j]) - key(edges[j - 1]) <= tolerance) ++j;
    each(std::vector<Edge>(edges.begin() + static_cast<std::ptrdiff_t>(i),
                           edges.begin() + static_cast<std::ptrdiff_t>(j)));
    i = j;
  }
}

}  // namespace

std::vector<Trace> trace_map(const Tile& tile, const CutPlane& cut) { return trace_map(tile, RockCells(tile), cut); }

std::vector<Trace> trace_map(const Tile& tile, const RockCells& rock, const CutPlane& cut) {
  require(std::abs(glm::length(cut.u) - 1.0) < 1e-9, "u", "a unit vector", glm::length(cut.u));
  require(std::abs(glm::length(cut.v) - 1.0) < 1e-9, "v", "a unit vector", glm::length(cut.v));
  require(std::abs(glm::dot(cut.u, cut.v)) < 1e-9, "v", "at right angles to u", glm::dot(cut.u, cut.v));
  require(cut.width > 0.0 && std::isfinite(cut.width), "width", "> 0 and finite", cut.width);
  require(cut.height > 0.0 && std::isfinite(cut.height), "height", "> 0 and finite", cut.height);

  const Vec3 normal = glm::cross(cut.u, cut.v);
  Box box;
  for (int corner = 0; corner < 4; ++corner)
    box.include(cut.origin + (corner & 1 ? cut.width : 0.0) * cut.u + (corner & 2 ? cut.height : 0.0) * cut.v);
  std::vector<Edge> edges;
  rock.visit_images(box, [&](const RockCells::Cell& cell, const Vec3& shift) {
    const Plane plane{normal, -glm::dot(normal, cut.origin - shift)};
    if (std::abs(plane.distance(cell.centre)) > cell.radius) return;
    for (const Polytope::Face& face : cell.shape.faces) {
      if (face.joint == kWall) continue;
      // Each joint lies between two cells: the one that it bounds on the right, or above, tells of it.
      Vec2 n(glm::dot(face.plane.normal, cut.u), glm::dot(face.plane.normal, cut.v));
      if (n.x < -1e-12 || (n.x < 1e-12 && n.y <= 0.0)) continue;
      const auto line = section(cell.shape, face, plane);
      if (!line) continue;
      const auto flat = [&](const Vec3& p) {
        const Vec3 d = p + shift - cut.origin;
        return Vec2(glm::dot(d, cut.u), glm::dot(d, cut.v));
      };
      const auto seen = cut_off(flat(line->first), flat(line->second), {cut.width, cut.height});
      if (!seen) continue;
      n = glm::normalize(n);
      const Vec2 along(-n.y, n.x);
      const double s = glm::dot(seen->first, along);
      const double t = glm::dot(seen->second, along);
      edges.push_back({face.joint, std::atan2(n.y, n.x), 0.5 * (glm::dot(seen->first, n) + glm::dot(seen->second, n)),
                       std::min(s, t), std::max(s, t)});
    }
  });
  std::vector<Trace> traces;
  const double tolerance = kSamePlace * tile.side;
  runs(
      edges, [](const Edge& e) { return e.joint; }, 0,
      [&](const std::vector<Edge>& of_joint) {
        runs(
            of_joint, [](const Edge& e) { return e.angle; }, kSameDirection,
            [&](const std::vector<Edge>& parallel) {
              runs(
                  parallel, [](const Edge& e) { return e.offset; }, tolerance,
                  [&](std::vector<Edge> line) { join(line, tolerance, tile, traces); });
            });
      });
  return traces;
}

double intensity_p21(std::span<const Trace> traces, const CutPlane& plane) noexcept {
  double sum = 0.0;
  for (const Trace& trace : traces) sum += trace.length();
  return sum / (plane.width * plane.height);
}

std::string trace_table(const Tile& tile, std::span<const Trace> traces) {
  std::string text = "x0,y0,x1,y1,set\n";
  char numbers[160];
  for (const Trace& trace : traces) {
    std::snprintf(numbers, sizeof numbers, "%.6g,%.6g,%.6g,%.6g,", trace.a.x, trace.a.y, trace.b.x, trace.b.y);
    const auto set = static_cast<std::size_t>(std::max(trace.set, 0));
    const bool is_named = trace.set >= 0 && !tile.sets[set].name.empty();
    text += numbers + (is_named ? tile.sets[set].name : std::to_string(trace.set)) + "\n";
  }
  return text;
}

}  // namespace outcrop

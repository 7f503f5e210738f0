#include "outcrop/fracture/polytope.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace outcrop {
namespace {

// Steps of the ball search: 0.92^96 of the first step is 0.03 % of the polytope's size.
constexpr int kBallSteps = 96;
constexpr double kBallShrink = 0.92;

// Corners of a new face, in order around its normal.
std::vector<std::uint32_t> ordered(std::vector<std::uint32_t> corners, const std::vector<Vec3>& vertices,
                                   const Vec3& n) {
  Vec3 middle{0.0};
  for (const std::uint32_t v : corners) middle += vertices[v];
  middle /= static_cast<double>(corners.size());
  const Vec3 u = glm::normalize(glm::cross(std::abs(n.z) < 0.7 ? Vec3(0, 0, 1) : Vec3(1, 0, 0), n));
  const Vec3 w = glm::cross(n, u);
  std::vector<std::pair<double, std::uint32_t>> turns;
  for (const std::uint32_t v : corners) {
    const Vec3 d = vertices[v] - middle;
    turns.emplace_back(std::atan2(glm::dot(d, w), glm::dot(d, u)), v);
  }
  std::sort(turns.begin(), turns.end());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = turns[i].second;
  return corners;
}

// Drops the vertices that no face uses any more.
void compact(Polytope& polytope) {
  constexpr std::uint32_t kUnused = ~0u;
  std::vector<std::uint32_t> moved(polytope.vertices.size(), kUnused);
  std::vector<Vec3> vertices;
  for (Polytope::Face& face : polytope.faces)
    for (std::uint32_t& v : face.loop) {
      if (moved[v] == kUnused) {
        moved[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(polytope.vertices[v]);
      }
      v = moved[v];
    }
  polytope.vertices = std::move(vertices);
}

}  // namespace

Box Polytope::bounds() const noexcept {
  Box box;
  for (const Vec3& v : vertices) box.include(v);
  return box;
}

double Polytope::volume() const noexcept {
  if (empty()) return 0.0;
  const Vec3 o = middle();
  double six = 0.0;
  for (const Face& face : faces)
    for (std::size_t i = 2; i < face.loop.size(); ++i)
      six +=
          glm::dot(vertices[face.loop[0]] - o, glm::cross(vertices[face.loop[i - 1]] - o, vertices[face.loop[i]] - o));
  return six / 6.0;
}

Vec3 Polytope::middle() const noexcept {
  Vec3 sum{0.0};
  for (const Vec3& v : vertices) sum += v;
  return sum / static_cast<double>(std::max<std::size_t>(vertices.size(), 1));
}

Interval Polytope::distances(const Plane& plane) const noexcept {
  Interval range;
  for (const Vec3& v : vertices) range.include(plane.distance(v));
  return range;
}

Polytope box_polytope(const Box& box) {
  Polytope result;
  for (int corner = 0; corner < 8; ++corner)
    result.vertices.push_back(
        {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y, corner & 4 ? box.hi.z : box.lo.z});
  constexpr std::uint32_t kLoops[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (int side = 0; side < 6; ++side) {
    Polytope::Face face;
    face.plane.normal = Vec3(0.0);
    face.plane.normal[side / 2] = side % 2 ? 1.0 : -1.0;
    face.plane.offset = side % 2 ? -box.hi[side / 2] : box.lo[side / 2];
    face.loop.assign(std::begin(kLoops[side]), std::end(kLoops[side]));
    result.faces.push_back(std::move(face));
  }
  return result;
}

Polytope clipped(const Polytope& polytope, const Plane& plane, int joint, double tolerance) {
  const std::size_t count = polytope.vertices.size();
  std::vector<double> s(count);
  bool outside = false;
  bool inside = false;
  for (std::size_t v = 0; v < count; ++v) {
    s[v] = plane.distance(polytope.vertices[v]);
    if (std::abs(s[v]) <= tolerance) s[v] = 0.0;
    outside = outside || s[v] > 0.0;
    inside = inside || s[v] < 0.0;
  }
  if (!inside) return {};
  if (!outside) return polytope;

  Polytope result;
  result.vertices = polytope.vertices;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cuts;  // edge → its vertex on the plane
  const auto cut = [&](std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);  // the same point from both faces of the edge
    const auto [it, is_new] = cuts.try_emplace({a, b}, static_cast<std::uint32_t>(result.vertices.size()));
    if (is_new) {
      const double t = s[a] / (s[a] - s[b]);
      result.vertices.push_back(polytope.vertices[a] + t * (polytope.vertices[b] - polytope.vertices[a]));
    }
    return it->second;
  };
  std::vector<std::uint32_t> corners;
  for (const Polytope::Face& face : polytope.faces) {
    Polytope::Face kept{face.plane, face.joint, {}};
    bool has_inside = false;
    for (std::size_t i = 0; i < face.loop.size(); ++i) {
      const std::uint32_t a = face.loop[i];
      const std::uint32_t b = face.loop[(i + 1) % face.loop.size()];
      if (s[a] <= 0.0) kept.loop.push_back(a);
      if (s[a] == 0.0) corners.push_back(a);
      has_inside = has_inside || s[a] < 0.0;
      if (s[a] * s[b] < 0.0) {
        kept.loop.push_back(cut(a, b));
        corners.push_back(kept.loop.back());
      }
    }
    if (has_inside && kept.loop.size() >= 3) result.faces.push_back(std::move(kept));
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  if (corners.size() >= 3) result.faces.push_back({plane, joint, ordered(corners, result.vertices, plane.normal)});
  compact(result);
  return result;
}

Ball inscribed_ball(std::span<const Plane> planes, const Vec3& start, double reach) noexcept {
  Ball best{start, -1e300};
  Vec3 p = start;
  double step = reach;
  for (int i = 0; i < kBallSteps; ++i) {
    double nearest = -1e300;
    const Plane* wall = nullptr;
    for (const Plane& plane : planes)
      if (const double d = plane.distance(p); d > nearest) {
        nearest = d;
        wall = &plane;
      }
    if (!wall) break;
    if (-nearest > best.radius) best = {p, -nearest};
    p -= step * wall->normal;
    step *= kBallShrink;
  }
  return best;
}

Ball inscribed_ball(const Polytope& polytope) {
  std::vector<Plane> planes;
  for (const Polytope::Face& face : polytope.faces) planes.push_back(face.plane);
  return inscribed_ball(planes, polytope.middle(), 0.25 * polytope.bounds().half_diagonal());
}

}  // namespace outcrop

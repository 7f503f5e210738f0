#include "outcrop/mesh/marching_cubes.h"

#include <cassert>
#include <limits>

namespace outcrop {
namespace {

constexpr int corner_number(const IVec3& corner) { return corner.x + 2 * corner.y + 4 * corner.z; }

int edge_between(const IVec3& a, const IVec3& b) {
  const int axis = a.x != b.x ? 0 : a.y != b.y ? 1 : 2;
  return 4 * axis + a[(axis + 1) % 3] + 2 * a[(axis + 2) % 3];
}

/// The corners of a face, counter-clockwise seen from outside the cube.
std::array<IVec3, 4> face_corners(int axis, int side) {
  constexpr int kWalk[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::array<IVec3, 4> corners;
  for (int i = 0; i < 4; ++i) {
    const int step = side == 1 ? i : 3 - i;
    corners[i][axis] = side;
    corners[i][(axis + 1) % 3] = kWalk[step][0];
    corners[i][(axis + 2) % 3] = kWalk[step][1];
  }
  return corners;
}

/// For each crossing edge the next one of its loop, else −1.
std::array<int, kCubeEdges> link_edges(int cube_case) {
  const auto rock = [&](const IVec3& corner) { return (cube_case >> corner_number(corner) & 1) != 0; };
  std::array<int, kCubeEdges> next;
  next.fill(-1);
  for (int face = 0; face < 6; ++face) {
    const auto corners = face_corners(face / 2, face % 2);
    for (int i = 0; i < 4; ++i) {
      if (rock(corners[i]) || !rock(corners[(i + 1) % 4])) continue;
      // Walk along one run of rock corners: entered after corner i, left before corner `end`.
      int end = (i + 2) % 4;
      while (rock(corners[end])) end = (end + 1) % 4;
      // An edge is entered on one of its two faces and left on the other, so that every edge gets one successor.
      next[edge_between(corners[i], corners[(i + 1) % 4])] = edge_between(corners[(end + 3) % 4], corners[end]);
    }
  }
  return next;
}

Vec3 middle(int edge) {
  const CubeEdge e = cube_edge(edge);
  Vec3 p(e.from);
  p[e.axis] += 0.5;
  return p;
}

/// Appends the cheapest admissible triangulation of a loop: dynamic programming over its chords.
void triangulate(const std::vector<int>& loop, std::vector<CubeTriangle>& triangles) {
  const int n = static_cast<int>(loop.size());
  constexpr double kForbidden = std::numeric_limits<double>::infinity();
  std::vector<double> cost(n * n, 0.0);
  std::vector<int> apex(n * n, -1);
  for (int span = 2; span < n; ++span) {
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      double best = kForbidden;
      const bool side = i == 0 && j == n - 1;
      if (side || !share_cube_face(loop[i], loop[j])) {
        for (int k = i + 1; k < j; ++k) {
          const Vec3 a = middle(loop[i]), b = middle(loop[k]), c = middle(loop[j]);
          const double total = cost[i * n + k] + cost[k * n + j] + glm::length(glm::cross(b - a, c - a));
          if (total < best) {
            best = total;
            apex[i * n + j] = k;
          }
        }
      }
      cost[i * n + j] = best;
    }
  }
  assert(cost[n - 1] < kForbidden);
  const auto emit = [&](const auto& self, int i, int j) -> void {
    if (j - i < 2) return;
    const int k = apex[i * n + j];
    self(self, i, k);
    triangles.push_back(
        {static_cast<std::uint8_t>(loop[i]), static_cast<std::uint8_t>(loop[k]), static_cast<std::uint8_t>(loop[j])});
    self(self, k, j);
  };
  emit(emit, 0, n - 1);
}

}  // namespace

bool share_cube_face(int edge_a, int edge_b) noexcept {
  const CubeEdge a = cube_edge(edge_a), b = cube_edge(edge_b);
  for (int axis = 0; axis < 3; ++axis)
    if (axis != a.axis && axis != b.axis && a.from[axis] == b.from[axis]) return true;
  return false;
}

const CubeCases& CubeCases::table() {
  static const CubeCases cases;
  return cases;
}

CubeCases::CubeCases() {
  for (int cube_case = 0; cube_case < 256; ++cube_case) {
    first_[cube_case] = static_cast<std::uint16_t>(triangles_.size());
    auto next = link_edges(cube_case);
    for (int start = 0; start < kCubeEdges; ++start) {
      std::vector<int> loop;
      for (int edge = start; next[edge] >= 0;) {
        loop.push_back(edge);
        const int following = next[edge];
        next[edge] = -1;
        edge = following;
      }
      if (!loop.empty()) triangulate(loop, triangles_);
    }
  }
  first_[256] = static_cast<std::uint16_t>(triangles_.size());
}

}  // namespace outcrop

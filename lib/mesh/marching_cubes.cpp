#include "outcrop/mesh/marching_cubes.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace outcrop {
namespace {

int edge_between(const CellShape& shape, int a, int b) {
  const auto joins = [&](const auto& e) { return (e[0] == a && e[1] == b) || (e[0] == b && e[1] == a); };
  return static_cast<int>(std::find_if(shape.edges.begin(), shape.edges.end(), joins) - shape.edges.begin());
}

/// For each crossing edge the next one of its loop, else −1.
std::vector<int> link_edges(const CellShape& shape, int cell_case) {
  const auto rock = [&](int corner) { return (cell_case >> corner & 1) != 0; };
  std::vector<int> next(shape.edges.size(), -1);
  for (const auto& face : shape.faces) {
    const std::size_t n = face.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (rock(face[i]) || !rock(face[(i + 1) % n])) continue;
      // Walk along one run of rock corners: entered after corner i, left before corner `end`.
      std::size_t end = (i + 2) % n;
      while (rock(face[end])) end = (end + 1) % n;
      // An edge is entered on one of its two faces and left on the other, so that every edge gets one successor.
      next[edge_between(shape, face[i], face[(i + 1) % n])] =
          edge_between(shape, face[(end + n - 1) % n], face[end]);
    }
  }
  return next;
}

/// Appends the cheapest admissible triangulation of a loop: dynamic programming over its chords.
void triangulate(const CellShape& shape, const std::vector<int>& loop, std::vector<CellTriangle>& triangles) {
  const int n = static_cast<int>(loop.size());
  const auto middle = [&](int i) {
    const auto& e = shape.edges[loop[i]];
    return 0.5 * (shape.corners[e[0]] + shape.corners[e[1]]);
  };
  constexpr double kForbidden = std::numeric_limits<double>::infinity();
  std::vector<double> cost(n * n, 0.0);
  std::vector<int> apex(n * n, -1);
  for (int span = 2; span < n; ++span) {
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      double best = kForbidden;
      const bool side = i == 0 && j == n - 1;
      if (side || !shape.share_face(loop[i], loop[j])) {
        for (int k = i + 1; k < j; ++k) {
          const Vec3 a = middle(i), b = middle(k), c = middle(j);
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

constexpr std::uint8_t corner_number(const IVec3& corner) {
  return static_cast<std::uint8_t>(corner.x + 2 * corner.y + 4 * corner.z);
}

}  // namespace

std::array<IVec3, 4> cube_face(int axis, int side) noexcept {
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

bool CellShape::share_face(int edge_a, int edge_b) const noexcept {
  return std::any_of(faces.begin(), faces.end(), [&](const auto& face) {
    const auto has = [&](std::uint8_t corner) { return std::find(face.begin(), face.end(), corner) != face.end(); };
    return has(edges[edge_a][0]) && has(edges[edge_a][1]) && has(edges[edge_b][0]) && has(edges[edge_b][1]);
  });
}

CellShape CellShape::cube() {
  CellShape shape;
  for (int i = 0; i < 8; ++i) shape.corners.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  for (int i = 0; i < kCubeEdges; ++i) {
    const CubeEdge e = cube_edge(i);
    const std::uint8_t from = corner_number(e.from);
    shape.edges.push_back({from, static_cast<std::uint8_t>(from | 1 << e.axis)});
  }
  for (int face = 0; face < 6; ++face) {
    auto& corners = shape.faces.emplace_back();
    for (const IVec3& c : cube_face(face / 2, face % 2)) corners.push_back(corner_number(c));
  }
  return shape;
}

CellShape CellShape::pyramid() {
  return {.corners = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0.5, 0.5, 0.5}},
          .edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}},
          .faces = {{0, 1, 2, 3}, {1, 0, 4}, {2, 1, 4}, {3, 2, 4}, {0, 3, 4}}};
}

CellShape CellShape::tetrahedron() {
  return {.corners = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
          .edges = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
          .faces = {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
}

CaseTable::CaseTable(const CellShape& shape) {
  for (int cell_case = 0; cell_case < 1 << shape.corners.size(); ++cell_case) {
    first_.push_back(static_cast<std::uint16_t>(triangles_.size()));
    auto next = link_edges(shape, cell_case);
    for (int start = 0; start < static_cast<int>(next.size()); ++start) {
      std::vector<int> loop;
      for (int edge = start; next[edge] >= 0;) {
        loop.push_back(edge);
        const int following = next[edge];
        next[edge] = -1;
        edge = following;
      }
      if (!loop.empty()) triangulate(shape, loop, triangles_);
    }
  }
  first_.push_back(static_cast<std::uint16_t>(triangles_.size()));
}

const CaseTable& CaseTable::cube() {
  static const CaseTable table(CellShape::cube());
  return table;
}
const CaseTable& CaseTable::pyramid() {
  static const CaseTable table(CellShape::pyramid());
  return table;
}
const CaseTable& CaseTable::tetrahedron() {
  static const CaseTable table(CellShape::tetrahedron());
  return table;
}

}  // namespace outcrop

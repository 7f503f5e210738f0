#include "outcrop/mesh/marching_cubes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

using Triangle = std::array<Vec3, 3>;

bool rock(int cube_case, const IVec3& corner) {
  return (cube_case >> (corner.x + 2 * corner.y + 4 * corner.z) & 1) != 0;
}

IVec3 far_end(const CubeEdge& edge) {
  IVec3 to = edge.from;
  to[edge.axis] += 1;
  return to;
}

/// Each directed side of the case's triangles and how often it occurs.
std::map<std::pair<int, int>, int> directed_sides(int cube_case) {
  std::map<std::pair<int, int>, int> sides;
  for (const CellTriangle& t : CaseTable::cube()[cube_case])
    for (int i = 0; i < 3; ++i) ++sides[{t[i], t[(i + 1) % 3]}];
  return sides;
}

/// The sides without an opposite: the segments on the cube's faces.
std::set<std::pair<int, int>> open_sides(int cube_case) {
  std::set<std::pair<int, int>> open;
  const auto sides = directed_sides(cube_case);
  for (const auto& [side, count] : sides)
    if (!sides.contains({side.second, side.first})) open.insert(side);
  return open;
}

/// Does the open segment p q cross the closed triangle?
bool crosses(const Vec3& p, const Vec3& q, const Triangle& t) {
  const Vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double dp = glm::dot(n, p - t[0]), dq = glm::dot(n, q - t[0]);
  if (dp * dq >= 0.0) return false;
  const Vec3 x = p + (q - p) * (dp / (dp - dq));
  for (int i = 0; i < 3; ++i)
    if (glm::dot(n, glm::cross(t[(i + 1) % 3] - t[i], x - t[i])) < 0.0) return false;
  return true;
}

TEST(MarchingCubes, CutEveryCrossingEdgeAndNoOther) {
  for (int c = 0; c < 256; ++c) {
    std::set<int> used;
    for (const CellTriangle& t : CaseTable::cube()[c]) used.insert(t.begin(), t.end());
    for (int e = 0; e < kCubeEdges; ++e) {
      const CubeEdge edge = cube_edge(e);
      EXPECT_EQ(used.contains(e), rock(c, edge.from) != rock(c, far_end(edge))) << "case " << c << " edge " << e;
    }
  }
}

TEST(MarchingCubes, LayNoDiagonalInAFaceOfTheCell) {
  for (int c = 0; c < 256; ++c) {
    const auto open = open_sides(c);
    for (const auto& [side, count] : directed_sides(c)) {
      EXPECT_EQ(count, 1) << "case " << c;
      EXPECT_EQ(CellShape::cube().share_face(side.first, side.second), open.contains(side)) << "case " << c;
    }
  }
}

TEST(MarchingCubes, CloseAgainstEveryNeighbour) {
  // Two cells that share a face: same four corners on it, anything elsewhere. Their segments on it must be opposite.
  for (int axis = 0; axis < 3; ++axis) {
    std::map<int, std::set<std::pair<int, int>>> low_side;  // Corners of the face → segments of the cell above it.
    const auto on_face = [&](int c, int side) {
      std::set<std::pair<int, int>> segments;
      for (const auto& s : open_sides(c)) {
        const CubeEdge a = cube_edge(s.first), b = cube_edge(s.second);
        if (a.axis == axis || b.axis == axis || a.from[axis] != side || b.from[axis] != side) continue;
        // Edges are told apart by axis and place on the face, whichever cell they are seen from.
        const auto key = [&](CubeEdge e) {
          e.from[axis] = 0;
          return 8 * e.axis + e.from.x + 2 * e.from.y + 4 * e.from.z;
        };
        segments.insert(side == 0 ? std::pair(key(a), key(b)) : std::pair(key(b), key(a)));
      }
      return segments;
    };
    const auto corners = [&](int c, int side) {
      int bits = 0;
      for (int i = 0; i < 4; ++i) {
        IVec3 corner{0};
        corner[axis] = side;
        corner[(axis + 1) % 3] = i & 1;
        corner[(axis + 2) % 3] = i >> 1;
        bits |= (rock(c, corner) ? 1 : 0) << i;
      }
      return bits;
    };
    for (int c = 0; c < 256; ++c) low_side[corners(c, 0)] = on_face(c, 0);
    for (int c = 0; c < 256; ++c) {
      EXPECT_EQ(on_face(c, 0), low_side[corners(c, 0)]) << "case " << c;
      EXPECT_EQ(on_face(c, 1), low_side[corners(c, 1)]) << "case " << c;
    }
  }
}

TEST(MarchingCubes, NeverIntersectThemselvesWhereverTheEdgesAreCut) {
  for (int c = 0; c < 256; ++c) {
    const auto triangles = CaseTable::cube()[c];
    for (int sample = 0; sample < 600; ++sample) {
      Rng rng(7, "cube", static_cast<std::uint64_t>(c * 1000 + sample));
      std::array<Vec3, kCubeEdges> cut;
      for (int e = 0; e < kCubeEdges; ++e) {
        const CubeEdge edge = cube_edge(e);
        cut[e] = Vec3(edge.from);
        // One in three near an end, where loops are most warped.
        const double t = rng.uniform(), extreme = rng.uniform();
        cut[e][edge.axis] += extreme < 1.0 / 6   ? 0.02 + 0.02 * t
                             : extreme > 5.0 / 6 ? 0.96 + 0.02 * t
                                                 : 0.02 + 0.96 * t;
      }
      for (const CellTriangle& a : triangles)
        for (const CellTriangle& b : triangles) {
          if (a == b) continue;
          const Triangle solid{cut[b[0]], cut[b[1]], cut[b[2]]};
          for (int i = 0; i < 3; ++i) {
            const int p = a[i], q = a[(i + 1) % 3];
            if (std::find(b.begin(), b.end(), p) != b.end() || std::find(b.begin(), b.end(), q) != b.end()) continue;
            ASSERT_FALSE(crosses(cut[p], cut[q], solid)) << "case " << c << " sample " << sample;
          }
        }
    }
  }
}

TEST(MarchingCubes, CutPyramidsAndTetrahedraByTheSameRules) {
  for (const auto& [shape, table] : {std::pair(CellShape::pyramid(), &CaseTable::pyramid()),
                                     std::pair(CellShape::tetrahedron(), &CaseTable::tetrahedron())}) {
    for (int c = 0; c < 1 << shape.corners.size(); ++c) {
      const auto triangles = (*table)[c];
      std::set<std::pair<int, int>> sides;
      std::set<int> used;
      for (const CellTriangle& t : triangles)
        for (int i = 0; i < 3; ++i) {
          used.insert(t[i]);
          EXPECT_TRUE(sides.emplace(t[i], t[(i + 1) % 3]).second) << "case " << c;
        }
      const auto rock = [&](int corner) { return (c >> corner & 1) != 0; };
      for (int e = 0; e < static_cast<int>(shape.edges.size()); ++e)
        EXPECT_EQ(used.contains(e), rock(shape.edges[e][0]) != rock(shape.edges[e][1])) << "case " << c;
      for (const auto& [a, b] : sides)
        EXPECT_EQ(shape.share_face(a, b), !sides.contains({b, a})) << "case " << c;
      for (std::uint64_t sample = 0; sample < 300; ++sample) {
        std::vector<Vec3> cut;
        for (std::size_t e = 0; e < shape.edges.size(); ++e) {
          Rng rng(8, "piece", (sample * 32 + static_cast<std::uint64_t>(c)) * 16 + e);
          cut.push_back(glm::mix(shape.corners[shape.edges[e][0]], shape.corners[shape.edges[e][1]],
                                 rng.uniform(0.02, 0.98)));
        }
        for (const CellTriangle& a : triangles)
          for (const CellTriangle& b : triangles)
            for (int i = 0; i < 3 && a != b; ++i) {
              const int p = a[i], q = a[(i + 1) % 3];
              if (std::find(b.begin(), b.end(), p) != b.end() || std::find(b.begin(), b.end(), q) != b.end()) continue;
              ASSERT_FALSE(crosses(cut[p], cut[q], {cut[b[0]], cut[b[1]], cut[b[2]]})) << "case " << c;
            }
      }
    }
  }
}

TEST(MarchingCubes, FaceTheAir) {
  for (int corner = 0; corner < 8; ++corner) {
    const auto triangles = CaseTable::cube()[1 << corner];
    ASSERT_EQ(triangles.size(), 1u);
    Triangle t;
    for (int i = 0; i < 3; ++i) {
      const CubeEdge e = cube_edge(triangles[0][i]);
      t[i] = Vec3(e.from);
      t[i][e.axis] += 0.5;
    }
    const Vec3 from_rock = t[0] - Vec3(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    EXPECT_GT(glm::dot(glm::cross(t[1] - t[0], t[2] - t[0]), from_rock), 0.0);
  }
}

}  // namespace
}  // namespace outcrop

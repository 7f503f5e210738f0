#include "cap.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <vector>

namespace outcrop::meshing {
namespace {

constexpr int kUnknown = -1;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<int, Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::No_constraint_intersection_tag>;

/// Counts, for each face, the curves between it and infinity: from outside inwards, one more at each constraint.
void count_curves(Triangulation& triangulation) {
  for (const auto face : triangulation.all_face_handles()) face->info() = kUnknown;
  std::vector<Triangulation::Face_handle> level{triangulation.infinite_face()}, next;
  for (int depth = 0; !level.empty(); ++depth, level.swap(next), next.clear()) {
    while (!level.empty()) {
      const auto face = level.back();
      level.pop_back();
      if (face->info() != kUnknown) continue;
      face->info() = depth;
      for (int i = 0; i < 3; ++i) {
        const auto neighbour = face->neighbor(i);
        if (neighbour->info() == kUnknown) (face->is_constrained(i) ? next : level).push_back(neighbour);
      }
    }
  }
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> fill_curves(std::span<const Vec2> points,
                                                      std::span<const std::pair<std::uint32_t, std::uint32_t>> edges) {
  std::vector<std::pair<Kernel::Point_2, std::uint32_t>> numbered;
  numbered.reserve(points.size());
  for (const Vec2& p : points)
    numbered.emplace_back(Kernel::Point_2(p.x, p.y), static_cast<std::uint32_t>(numbered.size()));
  Triangulation triangulation;
  triangulation.insert(numbered.begin(), numbered.end());
  std::vector<Triangulation::Vertex_handle> handles(points.size());
  for (const auto vertex : triangulation.finite_vertex_handles()) handles[vertex->info()] = vertex;
  for (const auto& [a, b] : edges) triangulation.insert_constraint(handles[a], handles[b]);
  count_curves(triangulation);

  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto face : triangulation.finite_face_handles())
    if (face->info() % 2 == 1)
      triangles.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  return triangles;
}

}  // namespace outcrop::meshing

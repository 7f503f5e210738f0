#include "rock_cells.h"

#include <algorithm>

namespace outcrop {
namespace {

constexpr double kTolerance = 1e-10;  // Of the side: as blocks were cut.

}  // namespace

RockCells::RockCells(const Tile& tile) : side_(tile.side), repeats_(tile.domain == Domain::Torus) {
  cells_.reserve(tile.blocks.size());
  for (const Block& block : tile.blocks) {
    Cell cell;
    cell.centre = block.centre;
    // Wide enough for the sharpest edge that joints leave.
    cell.shape = box_polytope(block.bounds.grown(20.0 * tile.aperture + 0.01 * tile.side).moved(block.centre));
    for (std::size_t i = 0; i < block.planes.size(); ++i) {
      const Plane& plane = block.planes[i];
      const double offset = plane.offset - 0.5 * tile.aperture - glm::dot(plane.normal, block.centre);
      cell.shape = clipped(cell.shape, {plane.normal, offset}, block.plane_joint[i], kTolerance * tile.side);
    }
    for (const Vec3& v : cell.shape.vertices) cell.radius = std::max(cell.radius, glm::length(v - cell.centre));
    cell.bounds = cell.shape.bounds();
    cells_.push_back(std::move(cell));
  }
}

std::vector<Crossing> RockCells::crossings(const Vec3& start, const Vec3& direction, double length) const {
  const double across = 2.0 * side_;  // longer than the box's diagonal
  std::vector<Crossing> result;
  if (repeats_) {
    for (double begun = 0.0; begun < length; begun += side_) {
      const Vec3 far = start + begun * direction;
      for (Crossing& crossing :
           stretch(far - side_ * glm::floor(far / side_), direction, std::min(side_, length - begun))) {
        crossing.at += begun;
        result.push_back(crossing);
      }
    }
  } else {
    result = stretch(start - across * direction, direction, 2.0 * across);
  }
  std::sort(result.begin(), result.end(), [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
  return result;
}

std::vector<Crossing> RockCells::stretch(const Vec3& from, const Vec3& direction, double length) const {
  std::vector<Crossing> result;
  Box box;
  box.include(from);
  box.include(from + length * direction);
  visit_images(box, [&](const Cell& cell, const Vec3& shift) {
    const Vec3 to_centre = cell.centre + shift - from;
    const Vec3 aside = to_centre - glm::dot(to_centre, direction) * direction;
    if (glm::dot(aside, aside) > cell.radius * cell.radius) return;
    double entry = -1e300;
    double exit = 1e300;
    const Polytope::Face* last = nullptr;
    for (const Polytope::Face& face : cell.shape.faces) {
      const double slope = glm::dot(face.plane.normal, direction);
      const double height = face.plane.distance(from - shift);
      if (slope > 0.0) {
        if (-height < exit * slope) {
          exit = -height / slope;
          last = &face;
        }
      } else if (slope < 0.0) {
        entry = std::max(entry, -height / slope);
      } else if (height > 0.0) {
        return;
      }
    }
    if (last && entry < exit && exit >= 0.0 && exit < length) result.push_back({exit, last->joint, last->plane.normal});
  });
  return result;
}

FaceMeasure measure(const Polytope& shape, const Polytope::Face& face) {
  Vec3 twice{0.0};
  const Vec3& o = shape.vertices[face.loop[0]];
  for (std::size_t i = 2; i < face.loop.size(); ++i)
    twice += glm::cross(shape.vertices[face.loop[i - 1]] - o, shape.vertices[face.loop[i]] - o);
  return {0.5 * glm::length(twice), face.plane.normal};
}

}  // namespace outcrop

/// The cells of a tile, for whoever measures it: blocks without their cracks, which fill space.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "outcrop/fracture/polytope.h"
#include "outcrop/fracture/tile.h"
#include "outcrop/fracture/trace_map.h"

namespace outcrop {

/// Where a line leaves a cell for the next one.
struct Crossing {
  double at = 0.0;    ///< Metres along the line.
  int joint = kWall;  ///< As in Block::plane_joint.
  Vec3 normal{0.0};   ///< Of the face.
};

/// Blocks grown by half the aperture: cells that fill the torus, or the box, with faces that neighbours share.
class RockCells {
 public:
  explicit RockCells(const Tile& tile);

  struct Cell {
    Vec3 centre{0.0};
    double radius = 0.0;  ///< Of the ball around the centre that holds the cell.
    Polytope shape;       ///< In tile space; Face.joint as in Block::plane_joint.
    Box bounds;
  };

  [[nodiscard]] const std::vector<Cell>& cells() const noexcept { return cells_; }
  [[nodiscard]] double side() const noexcept { return side_; }
  [[nodiscard]] bool repeats() const noexcept { return repeats_; }
  /// Of the torus or box, m³.
  [[nodiscard]] double volume() const noexcept { return side_ * side_ * side_; }

  /// Calls visit(cell, shift) for every image of a cell (moved by `shift`) whose bounds meet the box.
  template <class Visit>
  void visit_images(const Box& box, Visit&& visit) const {
    for (const Cell& cell : cells_) {
      if (!repeats_) {
        if (cell.bounds.overlaps(box)) visit(cell, Vec3(0.0));
        continue;
      }
      const Vec3 lo = glm::ceil((box.lo - cell.bounds.hi) / side_);
      const Vec3 hi = glm::floor((box.hi - cell.bounds.lo) / side_);
      for (double z = lo.z; z <= hi.z; ++z)
        for (double y = lo.y; y <= hi.y; ++y)
          for (double x = lo.x; x <= hi.x; ++x) visit(cell, side_ * Vec3(x, y, z));
    }
  }

  /// The joints that a line meets, in order: from `start` along the unit vector `direction`, around the torus. In a
  /// box: all those on the line through `start`, and last the wall. Cost: O(cells) for each side's length.
  [[nodiscard]] std::vector<Crossing> crossings(const Vec3& start, const Vec3& direction, double length) const;

 private:
  [[nodiscard]] std::vector<Crossing> stretch(const Vec3& from, const Vec3& direction, double length) const;

  double side_;
  bool repeats_;
  std::vector<Cell> cells_;
};

/// As in trace_map.h, of cells that are there already.
[[nodiscard]] std::vector<Trace> trace_map(const Tile& tile, const RockCells& rock, const CutPlane& plane);

/// The set of a face: an index into Tile::sets; −1 for a random joint, or the joint's own negative number.
[[nodiscard]] inline int set_of(const Tile& tile, int joint) {
  return joint < 0 ? joint : tile.discs[static_cast<std::size_t>(joint)].set;
}

/// Area and unit normal of a face.
struct FaceMeasure {
  double area = 0.0;
  Vec3 normal{0.0};
};
[[nodiscard]] FaceMeasure measure(const Polytope& shape, const Polytope::Face& face);

}  // namespace outcrop

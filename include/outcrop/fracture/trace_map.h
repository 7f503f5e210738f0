/// Trace maps: what an outcrop shows of the joints of a tile, a plane cut through it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "outcrop/core/vec.h"
#include "outcrop/fracture/tile.h"

namespace outcrop {

/// A rectangle in space: origin + [0, width] u + [0, height] v.
struct CutPlane {
  Vec3 origin{0.0};
  Vec3 u{1, 0, 0};      ///< Unit.
  Vec3 v{0, 1, 0};      ///< Unit, at right angles to u.
  double width = 20.0;  ///< Metres, > 0.
  double height = 20.0;
};

/// The line along which one joint meets the plane: all faces of blocks along it in one piece.
struct Trace {
  Vec2 a{0.0}, b{0.0};  ///< Ends, metres along u and v.
  int joint = kWall;    ///< As in Block::plane_joint.
  int set = -1;         ///< Index into Tile::sets; −1: a random joint, else the joint's own negative number.

  [[nodiscard]] double length() const noexcept { return glm::length(b - a); }
};

/// The traces of all joints in the rectangle, cut off at its border, ordered by joint. Tiles repeat.
/// @throws ParameterError unless u and v are unit vectors at right angles, and width and height positive.
/// Cost: O(images of blocks that the rectangle's box meets).
[[nodiscard]] std::vector<Trace> trace_map(const Tile& tile, const CutPlane& plane);

/// Total length over area, 1/m.
[[nodiscard]] double intensity_p21(std::span<const Trace> traces, const CutPlane& plane) noexcept;

/// The traces as comma separated text: a header, then x0, y0, x1, y1 (metres) and the set's name or number.
[[nodiscard]] std::string trace_table(const Tile& tile, std::span<const Trace> traces);

}  // namespace outcrop

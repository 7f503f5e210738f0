/// Bounded convex polyhedra, cut by planes: the shape of a cluster while joints split it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"
#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop {

/// A bounded convex polyhedron: every face knows its plane and the joint that it lies along.
struct Polytope {
  struct Face {
    Plane plane;                      ///< Outwards.
    int joint = -1;                   ///< Whatever the caller wants to know about the plane; -1 for the faces of a box.
    std::vector<std::uint32_t> loop;  ///< Vertices, counter-clockwise from outside; at least 3.
  };
  std::vector<Vec3> vertices;
  std::vector<Face> faces;  ///< In the order in which their planes cut.

  [[nodiscard]] bool empty() const noexcept { return faces.empty(); }
  [[nodiscard]] Box bounds() const noexcept;
  [[nodiscard]] double volume() const noexcept;
  /// The mean of the vertices: inside.
  [[nodiscard]] Vec3 middle() const noexcept;
  /// The range of the plane's distances over the polytope.
  [[nodiscard]] Interval distances(const Plane& plane) const noexcept;
};

[[nodiscard]] Polytope box_polytope(const Box& box);

/// The part of `polytope` inside the half-space; empty when there is none. Faces that vanish are dropped, the new face,
/// if there is one, comes last. Vertices within `tolerance` metres of the plane count as on it.
[[nodiscard]] Polytope clipped(const Polytope& polytope, const Plane& plane, int joint, double tolerance);

struct Ball {
  Vec3 centre{0.0};
  double radius = 0.0;  ///< < 0: no point inside was found.
};

/// The largest ball inside half-spaces, to about 1 %: steps away from the nearest plane, ever shorter.
/// @param start  Where to begin. @param reach  Length of the first step, metres: the size of what is searched.
[[nodiscard]] Ball inscribed_ball(std::span<const Plane> planes, const Vec3& start, double reach) noexcept;
/// The largest ball inside a polytope.
[[nodiscard]] Ball inscribed_ball(const Polytope& polytope);

}  // namespace outcrop

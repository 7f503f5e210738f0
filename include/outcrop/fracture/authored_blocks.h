/// Blocks that somebody shaped and placed in a tile; the cells of the rock are cut around them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "outcrop/fracture/polytope.h"

namespace outcrop {

/// A block that may be not convex: the union of convex parts. Tile frame, metres.
struct AuthoredBlock {
  std::vector<Polytope> parts;  ///< At least one; those of one block overlap or touch.
};

/// What is left of a cell beside authored blocks, in one piece.
struct CutCell {
  std::vector<Polytope> parts;  ///< Convex, their union is the piece; they overlap, so that it has no seams.
  std::vector<double> volumes;  ///< Of each part, what none before it holds, m³.
};

/// The convex hull of a mesh's vertices, in as few planes as hold its faces to within 0.01 degrees; nothing where
/// all lie in a plane.
[[nodiscard]] Polytope hull_polytope(std::span<const Vec3> points);

/// Parts of `a` that fill what is not in `b` and do not overlap: cut by the planes of `b` one after the other.
/// @param tolerance  Metres, as for clipped().
[[nodiscard]] std::vector<Polytope> difference(const Polytope& a, const Polytope& b, double tolerance);

/// Cuts a cell around obstacles: each face of an obstacle leaves the part of the cell that lies beyond its plane, and
/// parts that overlap are one piece. A part without room for a ball of `least_radius` is a chip: it is left out. Faces
/// along an obstacle have joint kAuthoredJoint.
[[nodiscard]] std::vector<CutCell> cut_around(const Polytope& cell, std::span<const Polytope> obstacles,
                                              double least_radius, double tolerance);

/// The parts that are not inside the ones before them, as one piece.
[[nodiscard]] CutCell without_covered(std::vector<Polytope> parts, double tolerance);

/// Parts of one block that reach into each other by `depth` metres: a face moves out where it lies against the others,
/// so that their union stays what it is.
[[nodiscard]] std::vector<Polytope> welded(const std::vector<Polytope>& parts, double depth, double tolerance);

/// The polytope with its planes moved out by `distance`, metres ≥ 0; corners like needles are cut off.
[[nodiscard]] Polytope grown(const Polytope& polytope, double distance, double tolerance);

[[nodiscard]] Polytope moved(Polytope polytope, const Vec3& by);

/// The first block that does not fit a tile, and why: it is empty, about as long as the tile, or overlaps another
/// (copies of the tile count). Empty when all fit.
[[nodiscard]] std::string misfit(std::span<const AuthoredBlock> blocks, double side);

}  // namespace outcrop

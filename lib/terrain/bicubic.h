/// Bicubic Hermite patches over a grid of samples, and what can be said about a whole patch.
#pragma once

#include <vector>

#include "outcrop/terrain/heightfield.h"

namespace outcrop::terrain {

/// A sample with its derivatives per column eastwards, per row southwards, and its twist.
struct Node {
  float h, hx, hy, hxy;
};

/// The patch between four neighbouring nodes; north is row r, south is row r + 1.
struct Patch {
  const Node& nw;
  const Node& ne;
  const Node& sw;
  const Node& se;
};

/// Value and derivatives per column and per row.
struct PatchSample {
  double h, hu, hv;
};

/// What holds everywhere in a patch or in a rectangle of patches.
struct PatchBound {
  float lo, hi;     ///< Contain h, metres.
  float slope;      ///< ≥ |∇h|.
  float curvature;  ///< ≥ the Hessian's spectral norm, 1/m.
};

/// The samples with slopes and twists limited against overshoot: a row or column that is monotone stays monotone, and
/// at a local extremum the curve passes the sample by at most 4/27 of the smaller step beside it. Method: central
/// differences under the limits of Fritsch and Carlson (1980), one axis at a time.
[[nodiscard]] std::vector<Node> hermite_nodes(const ElevationGrid& grid);
/// The samples alone, for bilinear patches.
[[nodiscard]] std::vector<Node> flat_nodes(const ElevationGrid& grid);

/// u, v in [0, 1] run east and south from the patch's north-western node.
[[nodiscard]] PatchSample evaluate_bicubic(const Patch& patch, double u, double v) noexcept;
/// evaluate_bicubic(patch, u, v).h, to the bit.
[[nodiscard]] double bicubic_value(const Patch& patch, double u, double v) noexcept;
[[nodiscard]] PatchSample evaluate_bilinear(const Patch& patch, double u, double v) noexcept;

/// Method: a patch and its derivatives lie in the convex hull of their Bézier control points (Farin 2002, chapter 15).
/// @param cell  Metres a column and a row.
[[nodiscard]] PatchBound bound_bicubic(const Patch& patch, const Vec2& cell) noexcept;
/// The curvature is infinite: the slope jumps from cell to cell.
[[nodiscard]] PatchBound bound_bilinear(const Patch& patch, const Vec2& cell) noexcept;

}  // namespace outcrop::terrain

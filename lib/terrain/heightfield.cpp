#include "outcrop/terrain/heightfield.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bicubic.h"
#include "each_position.h"
#include "nodata.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "pyramid.h"

namespace outcrop {
namespace {

using terrain::Node;
using terrain::Patch;
using terrain::PatchBound;
using terrain::PatchSample;
using terrain::Pyramid;

constexpr double kLargestElevation = 1e9;  // Metres; slopes and twists of such samples are still finite floats.
constexpr double kSmallestCell = 1e-6;     // Metres.
constexpr double kRoundingSlack = 1e-12;   // Relative; evaluation in doubles errs by some 1e-15 of the largest term.
constexpr double kAbsoluteSlack = 1e-9;    // Metres.

// Nodes that interpolate a map of samples over the patches of a grid, with their bounds.
struct Surface {
  std::vector<Node> nodes;
  Pyramid pyramid;
};

Surface make_surface(const ElevationGrid& grid, std::vector<Node> nodes, bool smooth) {
  const int columns = grid.width - 1, rows = grid.height - 1;
  const Vec2 cell{grid.cell_x, grid.cell_y};
  std::vector<PatchBound> bounds(static_cast<std::size_t>(columns) * rows);
  parallel_for(static_cast<std::size_t>(rows), [&](std::size_t row) {
    const Node* const north = &nodes[row * grid.width];
    const Node* const south = north + grid.width;
    for (int c = 0; c < columns; ++c) {
      const Patch patch{north[c], north[c + 1], south[c], south[c + 1]};
      bounds[row * columns + c] = smooth ? bound_bicubic(patch, cell) : bound_bilinear(patch, cell);
    }
  });
  return {std::move(nodes), Pyramid(columns, rows, std::move(bounds))};
}

/// Throws unless the grid holds what Heightfield needs; true when some sample is NaN.
bool checked_for_holes(const ElevationGrid& grid) {
  require(grid.width >= 2, "grid.width", "2 or more samples", grid.width);
  require(grid.height >= 2, "grid.height", "2 or more samples", grid.height);
  for (const double cell : {grid.cell_x, grid.cell_y}) {
    require(std::isfinite(cell) && cell >= kSmallestCell, "grid.cell", "at least 1e-6 m", cell);
  }
  require(std::isfinite(grid.origin.x) && std::isfinite(grid.origin.y), "grid.origin", "finite coordinates",
          "infinity or NaN");
  const std::size_t count = static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
  require(grid.elevations.size() == count, "grid.elevations", "width x height samples",
          static_cast<double>(grid.elevations.size()));
  std::size_t missing = 0;
  for (const float h : grid.elevations) {
    if (std::isnan(h)) {
      ++missing;
    } else {
      require(std::abs(h) <= kLargestElevation, "grid.elevations", "samples within ±1e9 m or NaN", h);
    }
  }
  require(missing < count, "grid.elevations", "at least one sample that is not NaN", "none");
  return missing > 0;
}

}  // namespace

struct Heightfield::Data {
  ElevationGrid grid;
  bool smooth;
  bool has_holes;
  Vec2 lo, hi;
  Vec2 per_metre;  ///< Columns and rows.
  Surface ground;
  Surface holes;  ///< Signed distances; empty without holes.

  /// Where a position falls: its patch's north-western node and the place in it. Positions outside are clamped.
  struct Place {
    int column, row;
    double u, v;
  };

  [[nodiscard]] double column_of(double x) const noexcept {
    // Written so that NaN becomes the western edge.
    return x > lo.x ? std::min((x - lo.x) * per_metre.x, static_cast<double>(grid.width - 1)) : 0.0;
  }
  [[nodiscard]] double row_of(double y) const noexcept {
    return y < hi.y ? std::min((hi.y - y) * per_metre.y, static_cast<double>(grid.height - 1)) : 0.0;
  }
  [[nodiscard]] Place place(double x, double y) const noexcept {
    const double s = column_of(x), t = row_of(y);
    const int column = std::min(static_cast<int>(s), grid.width - 2);
    const int row = std::min(static_cast<int>(t), grid.height - 2);
    return {column, row, s - column, t - row};
  }
  [[nodiscard]] Patch patch(const Surface& surface, const Place& at) const noexcept {
    const Node* const north = &surface.nodes[static_cast<std::size_t>(at.row) * grid.width + at.column];
    const Node* const south = north + grid.width;
    return {north[0], north[1], south[0], south[1]};
  }
  /// Per-step derivatives as a gradient in the map, 0 across the border outside.
  [[nodiscard]] Sample in_map(const PatchSample& s, double x, double y) const noexcept {
    const bool inside_x = x >= lo.x && x <= hi.x, inside_y = y >= lo.y && y <= hi.y;
    return {s.h, inside_x ? s.hu * per_metre.x : 0.0, inside_y ? -s.hv * per_metre.y : 0.0};
  }
  [[nodiscard]] PatchBound patch_bound(const Surface& surface, const Vec2& a, const Vec2& b) const noexcept {
    const Place north_west = place(a.x, b.y), south_east = place(b.x, a.y);
    return surface.pyramid.bound(north_west.column, south_east.column, north_west.row, south_east.row);
  }
  [[nodiscard]] Sample ground_at(double x, double y) const noexcept {
    const Place at = place(x, y);
    const Patch p = patch(ground, at);
    return in_map(smooth ? evaluate_bicubic(p, at.u, at.v) : evaluate_bilinear(p, at.u, at.v), x, y);
  }
  [[nodiscard]] double height_at(double x, double y) const noexcept {
    const Place at = place(x, y);
    const Patch p = patch(ground, at);
    return smooth ? terrain::bicubic_value(p, at.u, at.v) : evaluate_bilinear(p, at.u, at.v).h;
  }
  [[nodiscard]] Sample hole_at(double x, double y) const noexcept {
    const Place at = place(x, y);
    return in_map(evaluate_bilinear(patch(holes, at), at.u, at.v), x, y);
  }

  /// A rectangle's part in the domain: what h does outside it does on the border already. A rectangle wholly outside
  /// becomes a piece of the border.
  struct Rectangle {
    Vec2 lo, hi, centre, half;

    [[nodiscard]] double radius() const noexcept { return glm::length(half); }
  };
  [[nodiscard]] Rectangle inside(const Vec2& a, const Vec2& b) const noexcept {
    const Vec2 from = glm::clamp(glm::min(a, b), lo, hi), to = glm::clamp(glm::max(a, b), lo, hi);
    const Vec2 centre = 0.5 * (from + to);
    return {from, to, centre, glm::max(to - centre, centre - from)};
  }
  /// |∇h| over the rectangle, from its patches and from the gradient at its centre and the curvature around it.
  [[nodiscard]] double slope_bound(const Rectangle& r, const PatchBound& patches, const Sample& centre) const noexcept {
    if (!smooth) return patches.slope;
    const double near_centre =
        std::sqrt(centre.hx * centre.hx + centre.hy * centre.hy) + patches.curvature * r.radius();
    const double rounding = (std::abs(patches.lo) + std::abs(patches.hi)) / std::min(grid.cell_x, grid.cell_y);
    return std::min<double>(patches.slope, near_centre + kRoundingSlack * (near_centre + rounding));
  }
};

Heightfield::Heightfield(ElevationGrid grid, Interpolation interpolation) {
  const bool smooth = interpolation == Interpolation::Smooth;
  const bool has_holes = checked_for_holes(grid);
  Surface holes;
  if (has_holes) {
    ElevationGrid distances = grid;
    distances.elevations = terrain::hole_distances(grid);
    holes = make_surface(grid, terrain::flat_nodes(distances), false);
    grid.elevations = terrain::filled_elevations(grid);
  }
  Surface ground = make_surface(grid, smooth ? terrain::hermite_nodes(grid) : terrain::flat_nodes(grid), smooth);
  const Vec2 lo = grid.origin;
  const Vec2 hi = lo + Vec2((grid.width - 1) * grid.cell_x, (grid.height - 1) * grid.cell_y);
  const Vec2 per_metre{1.0 / grid.cell_x, 1.0 / grid.cell_y};
  data_ = std::make_shared<const Data>(
      Data{std::move(grid), smooth, has_holes, lo, hi, per_metre, std::move(ground), std::move(holes)});
}

Heightfield::Sample Heightfield::at(double x, double y) const noexcept { return data_->ground_at(x, y); }

void Heightfield::at(std::span<const double> x, std::span<const double> y, std::span<Sample> samples) const noexcept {
  terrain::each_position(x, y, samples, [this](double at_x, double at_y) { return data_->ground_at(at_x, at_y); });
}

void Heightfield::heights(std::span<const double> x, std::span<const double> y, std::span<double> h) const noexcept {
  terrain::each_position(x, y, h, [this](double at_x, double at_y) { return data_->height_at(at_x, at_y); });
}

Interval Heightfield::height_bound(const Vec2& a, const Vec2& b) const noexcept {
  const Data::Rectangle r = data_->inside(a, b);
  const PatchBound patches = data_->patch_bound(data_->ground, r.lo, r.hi);
  const Sample centre = data_->ground_at(r.centre.x, r.centre.y);
  // Three enclosures: the control points, the Lipschitz cone over the centre, and the tangent plane there with its
  // largest departure ½ H r². The last makes boxes much smaller than a cell sharp.
  double reach = data_->slope_bound(r, patches, centre) * r.radius();
  if (data_->smooth) {
    const double planar = std::abs(centre.hx) * r.half.x + std::abs(centre.hy) * r.half.y;
    reach = std::min(reach, planar + 0.5 * patches.curvature * r.radius() * r.radius());
  }
  reach += kAbsoluteSlack + kRoundingSlack * (std::abs(double{patches.lo}) + std::abs(double{patches.hi}) + reach);
  return intersection(Interval{patches.lo, patches.hi}, Interval{centre.h - reach, centre.h + reach});
}

double Heightfield::slope_bound(const Vec2& a, const Vec2& b) const noexcept {
  const Data::Rectangle r = data_->inside(a, b);
  const PatchBound patches = data_->patch_bound(data_->ground, r.lo, r.hi);
  return data_->slope_bound(r, patches, data_->ground_at(r.centre.x, r.centre.y));
}

Vec2 Heightfield::lo() const noexcept { return data_->lo; }
Vec2 Heightfield::hi() const noexcept { return data_->hi; }
const ElevationGrid& Heightfield::grid() const noexcept { return data_->grid; }
bool Heightfield::has_holes() const noexcept { return data_->has_holes; }

double Heightfield::hole_distance(double x, double y) const noexcept { return hole_at(x, y).h; }

Heightfield::Sample Heightfield::hole_at(double x, double y) const noexcept {
  if (!data_->has_holes) return {data_->lo.x - data_->hi.x + data_->lo.y - data_->hi.y, 0.0, 0.0};
  return data_->hole_at(x, y);
}

Interval Heightfield::hole_bound(const Vec2& a, const Vec2& b) const noexcept {
  if (!data_->has_holes) {
    const double nowhere = hole_distance(0.0, 0.0);
    return {nowhere, nowhere};
  }
  const Data::Rectangle r = data_->inside(a, b);
  const PatchBound patches = data_->patch_bound(data_->holes, r.lo, r.hi);
  const double centre = hole_distance(r.centre.x, r.centre.y);
  const double reach = r.radius() * (1.0 + kRoundingSlack) + kAbsoluteSlack;
  return intersection(Interval{patches.lo, patches.hi}, Interval{centre - reach, centre + reach});
}

}  // namespace outcrop

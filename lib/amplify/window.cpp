#include <algorithm>
#include <cmath>
#include <limits>

#include "outcrop/amplify/run_amplify.h"
#include "outputs.h"

namespace outcrop {
namespace {

constexpr double kDefaultTriangles = 4e6;   // A default run takes seconds, and its mesh opens everywhere.
constexpr double kRegionTriangles = 8e6;    // Who names a region may wait a little longer.
constexpr double kCellsPerBlock = 12.0;     // Fewer lose the rounding and the relief, more show nothing new.
constexpr double kBlocksPerSide = 5.0;      // 125 blocks a tile, as in Table 1 of Paris et al. 2020.
constexpr double kLeastCellsPerBlock = 5.0;  // Of the material with the smallest blocks.
constexpr double kTrianglesPerArea = 6.0;   // Of ground, in cells²: 3 on a smooth slope, 5.6 to 6.5 measured on rock.
constexpr double kFewestCells = 8.0;        // Across the shorter side of a region.
constexpr int kAreaSamples = 256;           // Across each side, for the area of the ground.

/// The area of the ground over a rectangle, m².
double ground_area(const Heightfield& heightfield, const Vec2& lo, const Vec2& hi) {
  const Vec2 step = (hi - lo) / double(kAreaSamples);
  double sum = 0.0;
  for (int j = 0; j < kAreaSamples; ++j)
    for (int i = 0; i < kAreaSamples; ++i) {
      const Heightfield::Sample s = heightfield.at(lo.x + (i + 0.5) * step.x, lo.y + (j + 0.5) * step.y);
      sum += std::sqrt(1.0 + s.hx * s.hx + s.hy * s.hy);
    }
  return sum * step.x * step.y;
}

double triangles(double area, double resolution) { return kTrianglesPerArea * area / (resolution * resolution); }

/// The cell that shows the blocks of every material well: those of the largest best.
double block_resolution(const Heightfield& heightfield, const StrataFile& strata) {
  const double default_side = default_tile_side(heightfield);
  double largest = 0.0, smallest = std::numeric_limits<double>::infinity();
  for (const RockMaterial& material : strata.materials) {
    const double side = material.tile_side > 0.0 ? material.tile_side : default_side;
    largest = std::max(largest, side);
    smallest = std::min(smallest, side);
  }
  return std::min(largest / kCellsPerBlock, smallest / kLeastCellsPerBlock) / kBlocksPerSide;
}

std::string rectangle(const Vec2& lo, const Vec2& hi) {
  return number_text(lo.x, 9) + " " + number_text(lo.y, 9) + " " + number_text(hi.x, 9) + " " + number_text(hi.y, 9);
}

Window given_region(const Heightfield& heightfield, const std::array<double, 4>& region) {
  Window window{.lo = {region[0], region[1]}, .hi = {region[2], region[3]}};
  const bool georeferenced = heightfield.grid().georeferenced;
  const Vec2 base = georeferenced ? Vec2(0.0) : heightfield.lo();
  window.lo += base;
  window.hi += base;
  const Vec2 lo = heightfield.lo(), hi = heightfield.hi();
  // Who copies the rectangle from a message must not fail by the last digit that it shows.
  const Vec2 slack = 1e-6 * (hi - lo) + 1e-8 * glm::max(glm::abs(lo), glm::abs(hi));
  const bool inside = window.lo.x < window.hi.x && window.lo.y < window.hi.y && window.lo.x >= lo.x - slack.x &&
                      window.lo.y >= lo.y - slack.y && window.hi.x <= hi.x + slack.x && window.hi.y <= hi.y + slack.y;
  require(inside, "--region",
          "X0 Y0 X1 Y1 with X0 < X1, Y0 < Y1 inside the terrain, " + rectangle(lo - base, hi - base) +
              (georeferenced ? " in map coordinates" : " in metres from its south-west corner"),
          rectangle(window.lo - base, window.hi - base));
  window.lo = glm::max(window.lo, lo);
  window.hi = glm::min(window.hi, hi);
  return window;
}

/// The steepest square that stays within the budget.
Window steepest_part(const Heightfield& heightfield, const StrataFile& strata, double resolution) {
  double size = std::sqrt(kDefaultTriangles / kTrianglesPerArea) * resolution;
  SteepWindow steep = steepest_window(heightfield, size, strata.placement.slope);
  const double excess = triangles(ground_area(heightfield, steep.lo, steep.hi), resolution) / kDefaultTriangles;
  if (excess > 1.0) {
    size /= std::sqrt(excess);
    steep = steepest_window(heightfield, size, strata.placement.slope);
  }
  Window window{.lo = steep.lo, .hi = steep.hi, .resolution = resolution};
  const Vec2 extent = window.hi - window.lo;
  window.note = "amplifying the steepest " + number_text(extent.x, 3) + " m x " + number_text(extent.y, 3) + " m at " +
                number_text(resolution, 3) + " m; --region or --resolution choose otherwise";
  return window;
}

/// Whole cells, so that the mesh ends where the region ends; outwards where the terrain goes on, else inwards.
void fit_to_cells(Window& window, const Heightfield& heightfield) {
  for (int axis = 0; axis < 2; ++axis) {
    const double cells = (window.hi[axis] - window.lo[axis]) / window.resolution;
    double whole = std::ceil(cells - 1e-6);
    if (window.lo[axis] + whole * window.resolution > heightfield.hi()[axis]) whole = std::floor(cells + 1e-6);
    window.hi[axis] = window.lo[axis] + std::max(whole, 1.0) * window.resolution;
  }
}

}  // namespace

Window choose_window(const Heightfield& heightfield, const StrataFile& strata, const AmplifyRun& run) {
  const double fine = block_resolution(heightfield, strata);
  Window window{.lo = heightfield.lo(), .hi = heightfield.hi(), .resolution = fine};
  if (run.region) window = given_region(heightfield, *run.region);
  const Vec2 extent = window.hi - window.lo;
  const double coarsest = std::min(extent.x, extent.y) / kFewestCells;
  if (run.resolution) {
    require(*run.resolution > 0.0 && *run.resolution <= coarsest, "--resolution",
            "metres above 0 and at most " + number_text(coarsest) + ", an eighth of the region", *run.resolution);
    window.resolution = *run.resolution;
  } else {
    const double needed = triangles(ground_area(heightfield, window.lo, window.hi), 1.0);
    if (run.region) {
      window.resolution = std::min(coarsest, std::max(fine, std::sqrt(needed / kRegionTriangles)));
      if (window.resolution > fine)
        window.note = "meshing at " + number_text(window.resolution, 3) + " m; --resolution chooses otherwise";
    } else if (needed / (fine * fine) > kDefaultTriangles) {
      window = steepest_part(heightfield, strata, fine);
    } else {
      window.resolution = std::min(coarsest, fine);
    }
  }
  fit_to_cells(window, heightfield);
  return window;
}

}  // namespace outcrop

#include "outcrop/mesh/polygonize.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "border.h"
#include "lattice.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "outcrop/core/rng.h"
#include "outcrop/mesh/marching_cubes.h"
#include "parts.h"
#include "sheet.h"

namespace outcrop {
namespace {

using meshing::Brick;
using meshing::BrickValues;
using meshing::Cell;
using meshing::Lattice;

/// Octree cells that the estimate follows at each level, and bricks that it evaluates.
constexpr std::size_t kSampledCells = 1024;
/// Peak bytes of polygonize: positions, normals and labels twice while chunks are joined, sides and sets of vertices,
/// the flags of triangles.
constexpr std::size_t kBytesAVertex = 2 * (2 * sizeof(Vec3f) + sizeof(Label)) + 3 * sizeof(std::uint32_t);
constexpr std::size_t kBytesATriangle = sizeof(std::array<std::uint32_t, 3>) + sizeof(std::uint32_t) + 1;
constexpr std::size_t kBytesABrick = 2 * sizeof(Brick);

PolygonizeEstimate estimate(const Field& field, const Lattice& lattice, const Task& task) {
  std::vector<Cell> cells = root_cells(lattice, field);
  double weight = 1.0;
  // One cell of every so many in Morton order stands for its neighbours: spread evenly over the surface. Which one is
  // random, since the order has periods of its own.
  const auto thin_out = [&](int level) {
    if (cells.size() <= kSampledCells) return;
    const double stride = static_cast<double>(cells.size()) / kSampledCells;
    Rng rng(0, "estimate", static_cast<std::uint64_t>(level));
    for (std::size_t i = 0; i < kSampledCells; ++i) {
      const double place = static_cast<double>(i) + rng.uniform();
      cells[i] = cells[static_cast<std::size_t>(place * stride)];
    }
    cells.resize(kSampledCells);
    weight *= stride;
  };
  for (int level = root_level(lattice); level > 0; --level) {
    const auto children = parallel_map(
        cells.size(), [&](std::size_t i) { return split(lattice, cells[i], level); }, task);
    cells.clear();
    for (const auto& part : children) cells.insert(cells.end(), part.begin(), part.end());
    thin_out(level);
  }
  struct Count {
    std::size_t bricks = 0, cells = 0, triangles = 0;
  };
  const auto counts = parallel_map(
      cells.size(),
      [&](std::size_t i) {
        Count count;
        Brick brick(lattice, cells[i].index);
        BrickValues values;
        if (values.sample(lattice, *cells[i].field->narrow(lattice.box(cells[i].index, 0)), brick)) count.bricks = 1;
        brick.for_each_mixed_cell([&](int, int cube_case) {
          ++count.cells;
          count.triangles += CubeCases::table()[cube_case].size();
        });
        return count;
      },
      task);
  Count sum;
  for (const Count& c : counts) {
    sum.bricks += c.bricks;
    sum.cells += c.cells;
    sum.triangles += c.triangles;
  }
  const auto scaled = [&](std::size_t n) {
    return static_cast<std::size_t>(std::llround(weight * static_cast<double>(n)));
  };
  PolygonizeEstimate result{.cells = scaled(sum.cells), .triangles = scaled(sum.triangles)};
  // A triangle mesh has about half as many vertices as triangles.
  result.bytes =
      result.triangles / 2 * kBytesAVertex + result.triangles * kBytesATriangle + scaled(sum.bricks) * kBytesABrick;
  return result;
}

/// Rounded up to two digits.
double two_digits_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit) * unit;
}

void require_memory(const PolygonizeEstimate& expected, const PolygonizeOptions& options) {
  if (options.memory_limit == 0 || expected.bytes <= options.memory_limit) return;
  const auto limit = static_cast<double>(options.memory_limit);
  // Triangles, and so bytes, go with the square of the resolution.
  const double fits = two_digits_up(options.resolution * std::sqrt(static_cast<double>(expected.bytes) / limit));
  const bool small = limit < 0x1p30;
  char bound[96];
  std::snprintf(bound, sizeof bound, "at least %g m for a memory limit of %.3g %s", fits,
                limit / (small ? 0x1p20 : 0x1p30), small ? "MiB" : "GiB");
  require(false, "resolution", bound, options.resolution);
}

}  // namespace

PolygonizeResult polygonize(const Field& field, const PolygonizeOptions& options, const Task& task) {
  const Lattice lattice = Lattice::over(options);
  if (options.memory_limit > 0) require_memory(estimate(field, lattice, task), options);
  PolygonizeResult result = mesh_sheet(field, lattice, options, task);
  const bool closed = options.border == Border::Closed, all_parts = options.parts == Parts::All && options.keep_voids;
  if (!closed && all_parts) return result;

  // Which rock hangs together is a question to the closed mesh: a ledge that the border cuts off has no wall without
  // it.
  const std::size_t sheet_triangles = result.mesh.triangles.size();
  result.mesh = close_sheet(std::move(result.mesh), field, lattice, options, task);
  if (!all_parts || !closed) {
    meshing::PartSelection selection = select_parts(result.mesh, lattice, options.parts, options.keep_voids);
    result.statistics.parts_removed = selection.parts_removed;
    result.statistics.voids_removed = selection.voids_removed;
    if (!closed) std::fill(selection.keep.begin() + sheet_triangles, selection.keep.end(), 0);
    const bool whole = std::find(selection.keep.begin(), selection.keep.end(), 0) == selection.keep.end();
    if (!whole) result.mesh = meshing::filtered(std::move(result.mesh), selection.keep);
  }
  return result;
}

PolygonizeEstimate estimate_polygonize(const Field& field, const PolygonizeOptions& options, const Task& task) {
  return estimate(field, Lattice::over(options), task);
}

}  // namespace outcrop

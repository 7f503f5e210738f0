#include "outcrop/mesh/polygonize.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "budget.h"
#include "lattice.h"
#include "mesh_region.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "outcrop/core/rng.h"
#include "outcrop/mesh/marching_cubes.h"

namespace outcrop {
namespace {

using meshing::Brick;
using meshing::BrickValues;
using meshing::Cell;
using meshing::Lattice;
using meshing::TriangleBudget;

/// Octree cells that the estimate follows at each level, and bricks that it evaluates.
constexpr std::size_t kSampledCells = 1024;
/// Peak bytes of polygonize: positions, normals and labels twice while chunks are joined, sides and sets of vertices,
/// the flags of triangles.
constexpr std::size_t kBytesAVertex = 2 * (2 * sizeof(Vec3f) + sizeof(Label)) + 3 * sizeof(std::uint32_t);
constexpr std::size_t kBytesATriangle = sizeof(std::array<std::uint32_t, 3>) + sizeof(std::uint32_t) + 1;

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
        Brick brick(lattice, cells[i].index, 0);
        BrickValues values;
        if (values.sample(lattice, *cells[i].field->narrow(lattice.box(cells[i].index, 0)), brick)) count.bricks = 1;
        brick.for_each_mixed_cell([&](int, int cube_case) {
          ++count.cells;
          count.triangles += CaseTable::cube()[cube_case].size();
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
      result.triangles / 2 * kBytesAVertex + result.triangles * kBytesATriangle;
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
  meshing::MeshCollector collector;
  MeshSink* const sinks[] = {&collector};
  PolygonizeResult result;
  const PieceOptions one_piece{.chunks = std::numeric_limits<std::size_t>::max() / 2};
  result.statistics = polygonize_pieces(field, options, one_piece, sinks, task);
  result.mesh = collector.take();
  return result;
}

PolygonizeStatistics polygonize_pieces(const Field& field, const PolygonizeOptions& options, const PieceOptions& pieces,
                                       std::span<MeshSink* const> sinks, const Task& task) {
  require(pieces.chunks >= 1, "chunks", "at least 1", static_cast<double>(pieces.chunks));
  const Lattice lattice = Lattice::over(options);
  if (options.memory_limit > 0) require_memory(estimate(field, lattice, task), options);
  std::optional<TriangleBudget> budget;
  if (options.triangles > 0) budget.emplace(field, options, task);
  for (;;) {
    const PolygonizeOptions used = budget ? budget->options() : options;
    const Lattice fitted = Lattice::over(used);
    meshing::Assembly assembly = mesh_region(field, fitted, used, pieces, task);
    if (budget && budget->refit(assembly.totals().triangles)) continue;
    assembly.emit(sinks, task);
    return assembly.statistics();
  }
}

PolygonizeEstimate estimate_polygonize(const Field& field, const PolygonizeOptions& options, const Task& task) {
  return estimate(field, Lattice::over(options), task);
}

}  // namespace outcrop

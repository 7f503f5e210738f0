#include "outcrop/mesh/polygonize.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "budget.h"
#include "error_samples.h"
#include "lattice.h"
#include "mesh_region.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

using meshing::ErrorSamples;
using meshing::kBalance;
using meshing::Lattice;
using meshing::TriangleBudget;

/// Peak bytes of polygonize: positions, normals and labels twice while chunks are joined, sides and sets of vertices,
/// the flags of triangles.
constexpr std::size_t kBytesAVertex = 2 * (2 * sizeof(Vec3f) + sizeof(Label)) + 3 * sizeof(std::uint32_t);
constexpr std::size_t kBytesATriangle = sizeof(std::array<std::uint32_t, 3>) + sizeof(std::uint32_t) + 1;

PolygonizeEstimate estimate(const Field& field, const PolygonizeOptions& options, const Task& task) {
  const Lattice lattice = Lattice::over(options);
  const auto counts = ErrorSamples(field, lattice, options.tolerance, task).expected(options.tolerance);
  const double balance = lattice.coarsest == 0 ? 1.0 : kBalance;
  const auto rounded = [](double n) { return static_cast<std::size_t>(std::llround(n)); };
  PolygonizeEstimate result{.cells = rounded(balance * counts.cells), .triangles = rounded(balance * counts.triangles)};
  if (options.triangles > 0) result = {.cells = options.triangles / 2, .triangles = options.triangles};
  // A triangle mesh has about half as many vertices as triangles.
  result.bytes = result.triangles / 2 * kBytesAVertex + result.triangles * kBytesATriangle;
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
  result.statistics = polygonize_pieces(field, options, {}, sinks, task);
  result.mesh = collector.take();
  return result;
}

PolygonizeStatistics polygonize_pieces(const Field& field, const PolygonizeOptions& options, const PieceOptions& pieces,
                                       std::span<MeshSink* const> sinks, const Task& task) {
  require(pieces.squares >= 1, "squares", "at least 1", static_cast<double>(pieces.squares));
  if (options.memory_limit > 0 && pieces.spool.empty()) require_memory(estimate(field, options, task), options);
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
  return estimate(field, options, task);
}

}  // namespace outcrop

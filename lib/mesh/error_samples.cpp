#include "error_samples.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "outcrop/core/parallel.h"
#include "outcrop/core/rng.h"
#include "outcrop/mesh/marching_cubes.h"
#include "refine.h"

namespace outcrop::meshing {
namespace {

/// Cells followed at each level.
constexpr std::size_t kSamples = 1024;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

struct Branch {
  Cell cell;
  double weight = 1.0;
  double least_error = kUnlimited;
};

/// One cell of every so many in Morton order stands for its neighbours: spread evenly over the surface. Which one is
/// random, since the order has periods of its own.
void thin_out(std::vector<Branch>& branches, int level) {
  if (branches.size() <= kSamples) return;
  const double stride = static_cast<double>(branches.size()) / kSamples;
  Rng rng(0, "estimate", static_cast<std::uint64_t>(level));
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double place = static_cast<double>(i) + rng.uniform();
    branches[i] = branches[static_cast<std::size_t>(place * stride)];
    branches[i].weight *= stride;
  }
  branches.resize(kSamples);
}

}  // namespace

ErrorSamples::ErrorSamples(const Field& field, const Lattice& lattice, double largest, const Task& task) {
  struct Found {
    Sample sample;
    std::vector<Cell> below;
  };
  std::vector<Branch> branches;
  for (Cell& root : root_cells(lattice, field)) branches.push_back({std::move(root)});
  for (int level = root_level(lattice); level >= 0; --level) {
    const auto look = [&](std::size_t i) {
      const Branch& b = branches[i];
      Found found{{b.weight, kUnlimited, b.least_error}, {}};
      const FieldPtr narrowed = b.cell.field->narrow(lattice.box(b.cell.index, level));
      if (level <= lattice.coarsest) {
        Brick brick(lattice, b.cell.index, level);
        BrickValues values;
        values.sample(lattice, *narrowed, brick);
        brick.for_each_mixed_cell([&](int, int cube_case) {
          ++found.sample.cells;
          found.sample.triangles += CaseTable::cube()[cube_case].size();
        });
        found.sample.error = level == 0 ? 0.0 : BrickError().measure(largest, lattice, *narrowed, brick, values);
      }
      if (level > 0) found.below = children(lattice, b.cell.index, level, narrowed);
      return found;
    };
    std::vector<Branch> next;
    for (const Found& f : parallel_map(branches.size(), look, task)) {
      if (f.sample.triangles > 0) samples_.push_back(f.sample);
      const double least = std::min(f.sample.least_error_above, f.sample.error);
      for (const Cell& cell : f.below) next.push_back({cell, f.sample.weight, least});
    }
    thin_out(next, level);
    branches = std::move(next);
  }
}

ErrorSamples::Counts ErrorSamples::expected(double tolerance) const {
  Counts sum;
  for (const Sample& s : samples_) {
    if (s.error > tolerance || tolerance >= s.least_error_above) continue;
    sum.cells += s.weight * static_cast<double>(s.cells);
    sum.triangles += s.weight * static_cast<double>(s.triangles);
  }
  return sum;
}

}  // namespace outcrop::meshing

#include "budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "outcrop/core/parallel.h"
#include "outcrop/core/rng.h"
#include "outcrop/mesh/marching_cubes.h"
#include "refine.h"

namespace outcrop::meshing {
namespace {

/// Cells measured at each level.
constexpr std::size_t kSamples = 640;
/// Good enough, as a share of what is wanted; and how often to mesh again.
constexpr double kClose = 0.08;
constexpr int kMostFits = 3;
/// Bricks between larger and smaller ones are smaller than their own error asks for: seen on rough ground.
constexpr double kBalance = 1.1;
/// Tolerances to look among, in finest cells.
constexpr double kFinestTolerance = 1e-4, kCoarsestTolerance = 1e3;

struct Branch {
  Cell cell;
  double weight = 1.0;
  double least_error = std::numeric_limits<double>::infinity();
};

/// One of every so many in Morton order stands for its neighbours.
void thin_out(std::vector<Branch>& branches, int level) {
  if (branches.size() <= kSamples) return;
  const double stride = static_cast<double>(branches.size()) / kSamples;
  Rng rng(0, "budget", static_cast<std::uint64_t>(level));
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double place = static_cast<double>(i) + rng.uniform();
    branches[i] = branches[static_cast<std::size_t>(place * stride)];
    branches[i].weight *= stride;
  }
  branches.resize(kSamples);
}

}  // namespace

TriangleBudget::TriangleBudget(const Field& field, const PolygonizeOptions& options, const Task& task)
    : options_(options), wanted_(static_cast<double>(options.triangles)) {
  options_.tolerance = options.resolution;  // Any: makes a lattice with levels.
  task.begin("fitting the tolerance");
  measure(field, Lattice::over(options_), task);
  correction_ = kBalance;
  fit();
}

void TriangleBudget::measure(const Field& field, const Lattice& lattice, const Task& task) {
  std::vector<Branch> branches;
  for (Cell& root : root_cells(lattice, field)) branches.push_back({std::move(root)});
  for (int level = root_level(lattice); level >= 0; --level) {
    struct Found {
      Sample sample;
      std::vector<Cell> below;
    };
    auto found = parallel_map(
        branches.size(),
        [&](std::size_t i) {
          const Branch& b = branches[i];
          Found result{{b.weight, std::numeric_limits<double>::infinity(), b.least_error, 0}, {}};
          const FieldPtr narrowed = b.cell.field->narrow(lattice.box(b.cell.index, level));
          if (level <= lattice.coarsest) {
            Brick brick(lattice, b.cell.index, level);
            BrickValues values;
            values.sample(lattice, *narrowed, brick);
            brick.for_each_mixed_cell(
                [&](int, int cube_case) { result.sample.triangles += CaseTable::cube()[cube_case].size(); });
            result.sample.error = level == 0 ? 0.0
                                             : BrickError().measure(std::numeric_limits<double>::infinity(), lattice,
                                                                    *narrowed, brick, values);
          }
          if (level > 0) result.below = children(lattice, b.cell.index, level, narrowed);
          return result;
        },
        task);
    std::vector<Branch> next;
    for (const Found& f : found) {
      if (f.sample.triangles > 0) samples_.push_back(f.sample);
      const double least = std::min(f.sample.least_error_above, f.sample.error);
      for (const Cell& cell : f.below) next.push_back({cell, f.sample.weight, least});
    }
    thin_out(next, level);
    branches = std::move(next);
  }
}

double TriangleBudget::expected(double tolerance) const {
  double sum = 0.0;
  for (const Sample& s : samples_)
    if (s.error <= tolerance && tolerance < s.least_error_above) sum += s.weight * static_cast<double>(s.triangles);
  return sum;
}

void TriangleBudget::fit() {
  const double finest = expected(0.0);
  if (finest == 0.0) return;
  if (wanted_ > finest) {  // Triangles of uniform cells go with the inverse square of their size.
    options_.tolerance = 0.0;
    options_.resolution *= std::sqrt(finest / wanted_);
    return;
  }
  double lo = std::log(kFinestTolerance * options_.resolution), hi = std::log(kCoarsestTolerance * options_.resolution);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lo + hi);
    (correction_ * expected(std::exp(middle)) > wanted_ ? lo : hi) = middle;
  }
  options_.tolerance = std::exp(hi);
}

bool TriangleBudget::refit(std::size_t made) {
  const double ratio = static_cast<double>(made) / wanted_;
  if (made == 0 || std::abs(ratio - 1.0) <= kClose || ++fits_ >= kMostFits) return false;
  const double before_tolerance = options_.tolerance, before_resolution = options_.resolution;
  if (options_.tolerance == 0.0) {
    options_.resolution *= std::sqrt(ratio);
  } else {
    correction_ = static_cast<double>(made) / expected(options_.tolerance);
    fit();
  }
  return options_.tolerance != before_tolerance || options_.resolution != before_resolution;
}

}  // namespace outcrop::meshing

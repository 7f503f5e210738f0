#include "budget.h"

#include <cmath>
#include <limits>

namespace outcrop::meshing {
namespace {

/// Good enough, as a share of what is wanted; and how often to mesh again.
constexpr double kClose = 0.08;
constexpr int kMostFits = 3;
/// Tolerances to look among, in finest cells.
constexpr double kFinestTolerance = 1e-4, kCoarsestTolerance = 1e3;

/// With a tolerance: its lattice has levels.
PolygonizeOptions with_levels(PolygonizeOptions options) {
  options.tolerance = options.resolution;
  return options;
}

}  // namespace

TriangleBudget::TriangleBudget(const Field& field, const PolygonizeOptions& options, const Task& task)
    : options_(with_levels(options)), samples_(field, Lattice::over(options_), std::numeric_limits<double>::infinity(), task),
      wanted_(static_cast<double>(options.triangles)) {
  fit();
}

void TriangleBudget::fit() {
  const double finest = samples_.expected(0.0).triangles;
  if (finest == 0.0) return;
  if (wanted_ > finest) {  // Triangles of uniform cells go with the inverse square of their size.
    options_.tolerance = 0.0;
    options_.resolution *= std::sqrt(finest / wanted_);
    return;
  }
  double lo = std::log(kFinestTolerance * options_.resolution), hi = std::log(kCoarsestTolerance * options_.resolution);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lo + hi);
    (correction_ * samples_.expected(std::exp(middle)).triangles > wanted_ ? lo : hi) = middle;
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
    correction_ = static_cast<double>(made) / samples_.expected(options_.tolerance).triangles;
    fit();
  }
  return options_.tolerance != before_tolerance || options_.resolution != before_resolution;
}

}  // namespace outcrop::meshing

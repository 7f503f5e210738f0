#include "budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace outcrop::meshing {
namespace {

/// Good enough, as a share of what is wanted; and how often to mesh again.
constexpr double kClose = 0.08;
constexpr int kMostFits = 3, kMostFitsOfFew = 8;
/// Meshes that are made in no time.
constexpr std::size_t kFewTriangles = 200'000;
/// Between two tolerances that were tried the next one keeps this share of their distance away from both.
constexpr double kLeastStep = 0.1;
/// Tolerances to look among, in finest cells.
constexpr double kFinestTolerance = 1e-4, kCoarsestTolerance = 1e3;

/// How often to look for a coarser resolution, and by how much it is coarser at least.
constexpr int kMostCoarsenings = 8;
constexpr double kLeastCoarsening = 1.1;

}  // namespace

TriangleBudget::TriangleBudget(const Field& field, const PolygonizeOptions& options, const Task& task)
    : field_(field), task_(task), options_(options), wanted_(static_cast<double>(options.triangles)) {
  take_samples();
  fit();
}

void TriangleBudget::take_samples() {
  fine_.reset();
  coarse_.reset();
  options_.tolerance = options_.resolution;  // With a tolerance: its lattice has levels.
  samples_.emplace(field_, Lattice::over(options_), std::numeric_limits<double>::infinity(), task_);
}

void TriangleBudget::fit() {
  const double finest = samples_->expected(0.0).triangles;
  if (finest == 0.0) return;
  if (wanted_ > finest) {  // Triangles of uniform cells go with the inverse square of their size.
    options_.tolerance = 0.0;
    options_.resolution *= std::sqrt(finest / wanted_);
    return;
  }
  const auto triangles = [&](double tolerance) { return correction_ * samples_->expected(tolerance).triangles; };
  for (int i = 0; i < kMostCoarsenings; ++i) {
    const double fewest = triangles(kCoarsestTolerance * options_.resolution);
    if (fewest <= wanted_) break;
    options_.resolution *= std::max(std::sqrt(fewest / wanted_), kLeastCoarsening);
    take_samples();
  }
  double lo = std::log(kFinestTolerance * options_.resolution), hi = std::log(kCoarsestTolerance * options_.resolution);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lo + hi);
    (triangles(std::exp(middle)) > wanted_ ? lo : hi) = middle;
  }
  options_.tolerance = std::exp(hi);
}

void TriangleBudget::look_between(const Tried& fine, const Tried& coarse) {
  const double many = std::log(fine.ratio), few = std::log(coarse.ratio);
  const double share = std::clamp(many / (many - few), kLeastStep, 1.0 - kLeastStep);
  options_.tolerance = fine.tolerance * std::pow(coarse.tolerance / fine.tolerance, share);
}

bool TriangleBudget::refit(std::size_t made) {
  const double ratio = static_cast<double>(made) / wanted_, miss = std::abs(std::log(ratio));
  if (made == 0 || std::abs(ratio - 1.0) <= kClose || fits_ < 0) return false;
  if (miss < best_miss_) {
    best_miss_ = miss;
    best_ = options_;
  }
  if (++fits_ >= (made <= kFewTriangles ? kMostFitsOfFew : kMostFits)) {
    if (miss == best_miss_) return false;
    options_ = best_;
    fits_ = -1;
    return true;
  }
  if (options_.tolerance == 0.0) {
    options_.resolution *= std::sqrt(ratio);
    return true;
  }
  (ratio > 1.0 ? fine_ : coarse_) = Tried{options_.tolerance, ratio};
  if (fine_ && coarse_) {
    look_between(*fine_, *coarse_);
    return true;
  }
  correction_ = static_cast<double>(made) / samples_->expected(options_.tolerance).triangles;
  const double before = options_.tolerance;
  fit();
  if (options_.tolerance == before) {  // No other tolerance promises more; other cells may.
    options_.resolution *= std::sqrt(ratio);
    take_samples();
    fit();
  }
  return true;
}

}  // namespace outcrop::meshing

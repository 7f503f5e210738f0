/// From a wanted number of triangles to a tolerance.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "error_samples.h"
#include "outcrop/core/task.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop::meshing {

/// Finds the tolerance that gives about `options.triangles` triangles; where all of the finest cells would not do a
/// finer resolution, and where all of the coarsest would be too many a coarser one.
class TriangleBudget {
 public:
  TriangleBudget(const Field& field, const PolygonizeOptions& options, const Task& task);
  /// What to mesh with.
  [[nodiscard]] const PolygonizeOptions& options() const noexcept { return options_; }
  /// Takes in how many triangles that gave. @return true when other options() promise to come closer.
  bool refit(std::size_t made);

 private:
  /// A tolerance that was tried, and the triangles that it gave over those wanted.
  struct Tried {
    double tolerance, ratio;
  };
  void fit();
  void take_samples();
  void look_between(const Tried& fine, const Tried& coarse);

  const Field& field_;
  const Task& task_;
  PolygonizeOptions options_;
  std::optional<ErrorSamples> samples_;
  double wanted_;
  double correction_ = kBalance;  ///< Triangles made over triangles expected.
  std::optional<Tried> fine_, coarse_;  ///< Closest with too many, and with too few.
  PolygonizeOptions best_;
  double best_miss_ = std::numeric_limits<double>::infinity();
  int fits_ = 0;
};

}  // namespace outcrop::meshing

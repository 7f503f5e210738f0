/// From a wanted number of triangles to a tolerance.
#pragma once

#include <cstddef>

#include "error_samples.h"
#include "outcrop/core/task.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop::meshing {

/// Finds the tolerance, and where all of the finest cells would not do the resolution, that give about
/// `options.triangles` triangles.
class TriangleBudget {
 public:
  TriangleBudget(const Field& field, const PolygonizeOptions& options, const Task& task);
  /// What to mesh with.
  [[nodiscard]] const PolygonizeOptions& options() const noexcept { return options_; }
  /// Takes in how many triangles that gave. @return true when other options() promise to come closer.
  bool refit(std::size_t made);

 private:
  void fit();

  PolygonizeOptions options_;
  ErrorSamples samples_;
  double wanted_;
  double correction_ = kBalance;  ///< Triangles made over triangles expected.
  int fits_ = 0;
};

}  // namespace outcrop::meshing

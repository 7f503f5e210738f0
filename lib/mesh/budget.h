/// From a wanted number of triangles to a tolerance.
#pragma once

#include <cstddef>
#include <vector>

#include "lattice.h"
#include "outcrop/core/task.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop::meshing {

/// Finds the tolerance, and where all of the finest cells would not do the resolution, that give about
/// `options.triangles` triangles.
///
/// A sample of the octree's cells is measured once, some hundreds at each level; how many triangles a tolerance gives is
/// then a sum over those that would be leaves. Cost: below a second.
class TriangleBudget {
 public:
  TriangleBudget(const Field& field, const PolygonizeOptions& options, const Task& task);
  /// What to mesh with.
  [[nodiscard]] const PolygonizeOptions& options() const noexcept { return options_; }
  /// Takes in how many triangles that gave. @return true when other options() promise to come closer.
  bool refit(std::size_t made);

 private:
  /// A brick that is a leaf when its own error is at most the tolerance and the errors of all above it are more.
  struct Sample {
    double weight, error, least_error_above;
    std::size_t triangles;
  };
  void measure(const Field& field, const Lattice& lattice, const Task& task);
  [[nodiscard]] double expected(double tolerance) const;
  void fit();

  PolygonizeOptions options_;
  double wanted_;
  double correction_ = 1.0;  ///< Triangles made over triangles expected.
  int fits_ = 0;
  std::vector<Sample> samples_;
};

}  // namespace outcrop::meshing

/// What a mesh will have, from a sample of the octree's cells.
#pragma once

#include <vector>

#include "lattice.h"
#include "outcrop/core/task.h"

namespace outcrop::meshing {

/// About a thousand cells at each level, measured once; what a tolerance gives is then a sum over those that would be
/// leaves. The sums lack what balance splits. Cost: below a second.
class ErrorSamples {
 public:
  /// @param largest  Tolerance that will be asked for; errors beyond it are not measured to their end, which is dear.
  ErrorSamples(const Field& field, const Lattice& lattice, double largest, const Task& task);

  struct Counts {
    double cells = 0.0, triangles = 0.0;
  };
  [[nodiscard]] Counts expected(double tolerance) const;

 private:
  /// A brick that is a leaf when its own error is at most the tolerance and the errors of all above it are more.
  struct Sample {
    double weight, error, least_error_above;
    std::size_t cells = 0, triangles = 0;
  };
  std::vector<Sample> samples_;
};

/// Bricks between larger and smaller ones are smaller than their own error asks for: by so much are there more
/// triangles, seen on rough ground.
inline constexpr double kBalance = 1.1;

}  // namespace outcrop::meshing

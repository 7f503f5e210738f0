/// Relief images: small-scale surface detail that the gradient warp carves into blocks.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "outcrop/core/image.h"
#include "outcrop/core/vec.h"

namespace outcrop {

/// A tileable displacement function d(u, v) in [0, 1], C¹: 1 leaves the surface, 0 is deepest.
///
/// The image repeats every `period` metres in u and v. u runs to the image's right, v towards its top. Evaluated as a
/// quadratic B-spline of the pixels, so slopes are continuous and bounded by pixel differences.
class Relief {
 public:
  /// @param image   One channel is taken (the first); values are divided by image.full_scale and clamped to [0, 1].
  /// @param period  Metres a repetition, > 0.
  Relief(const Image& image, double period);

  /// d and its derivatives at (u, v) in metres.
  struct Sample {
    float d, du, dv;
  };
  [[nodiscard]] Sample at(double u, double v) const noexcept;
  /// Largest |∇d| in 1/m.
  [[nodiscard]] double slope() const noexcept { return slope_; }
  [[nodiscard]] double period() const noexcept { return period_; }
  /// The same relief with features shorter than `length` metres faded out, for coarse meshes (design decision 10).
  [[nodiscard]] Relief smoothed(double length) const;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<float> pixels_;
  double period_ = 1.0;
  double slope_ = 0.0;
};

using ReliefPtr = std::shared_ptr<const Relief>;

/// @throws InputError when the file is no image; ParameterError for a period ≤ 0.
[[nodiscard]] ReliefPtr read_relief(const std::filesystem::path& path, double period);

}  // namespace outcrop

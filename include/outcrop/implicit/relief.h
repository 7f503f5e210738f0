/// Relief images: small-scale surface detail that the gradient warp carves into blocks.
#pragma once

#include <cstddef>
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
  /// @throws ParameterError for a period ≤ 0, an image without pixels, or pixels that are not finite.
  Relief(const Image& image, double period);

  /// d and its derivatives (1/m) at (u, v) in metres.
  struct Sample {
    float d, du, dv;
  };
  [[nodiscard]] Sample at(double u, double v) const noexcept;
  /// The same at phases in [0, 1]: u / period − floor(u / period).
  [[nodiscard]] Sample at_phase(float u, float v) const noexcept;
  /// The pixels for a hot loop of one's own: pixel (i, j), v upwards, sees the 3 x 3 at first + j · stride + i, for i
  /// in [0, width], j in [0, height]; a fourth column may be read. Borrowed.
  struct Pixels {
    const float* first;
    std::ptrdiff_t stride;
    int width, height;
  };
  [[nodiscard]] Pixels pixels() const noexcept { return {padded_.data(), stride_, width_, height_}; }
  /// Bounds |∇d| in 1/m, from the differences of the pixels that each patch of the spline sees.
  [[nodiscard]] double slope() const noexcept { return slope_; }
  [[nodiscard]] double period() const noexcept { return period_; }
  /// The mean of d: what `smoothed` tends to.
  [[nodiscard]] double mean() const noexcept;
  /// The same relief with features shorter than `length` metres faded out, for coarse meshes (design decision 10):
  /// tends to the mean as `length` passes the period, so that a coarse mesh sees the mean depth. Cost: O(pixels).
  /// Method: three periodic extended box filters @cite gwosdek_2011, section 2.
  [[nodiscard]] Relief smoothed(double length) const;

 private:
  Relief() = default;
  void finish(std::vector<float> pixels);

  int width_ = 0;
  int height_ = 0;
  int stride_ = 0;
  std::vector<float> padded_;  ///< v upwards; one pixel of the neighbours before each row and column, two behind.
  double period_ = 1.0;
  double slope_ = 0.0;
};

using ReliefPtr = std::shared_ptr<const Relief>;

/// @throws InputError when the file is no image; ParameterError for a period ≤ 0.
[[nodiscard]] ReliefPtr read_relief(const std::filesystem::path& path, double period);

}  // namespace outcrop

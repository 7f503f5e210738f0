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
  /// The same at phases in [0, 1]: u / period − floor(u / period). The hot path; derivatives are 0 unless `Slopes`.
  template <bool Slopes>
  [[nodiscard]] Sample at_phase(float u, float v) const noexcept;
  /// Bounds |∇d| in 1/m, from the differences of the pixels that each patch of the spline sees.
  [[nodiscard]] double slope() const noexcept { return slope_; }
  [[nodiscard]] double period() const noexcept { return period_; }
  /// The mean of d: what `smoothed` tends to.
  [[nodiscard]] double mean() const noexcept;
  /// The same relief with features shorter than `length` metres faded out, for coarse meshes (design decision 10): tends
  /// to the mean as `length` passes the period, so that a coarse mesh sees the mean depth.
  /// Cost: O(pixels). Method: three periodic extended box filters @cite gwosdek_2011, section 2.
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

template <bool Slopes>
inline Relief::Sample Relief::at_phase(float u, float v) const noexcept {
  const float column = u * static_cast<float>(width_);
  const float row = v * static_cast<float>(height_);
  const int i = static_cast<int>(column);
  const int j = static_cast<int>(row);
  const float a = column - static_cast<float>(i), b = row - static_cast<float>(j);  // In [0, 1): ½ is the pixel's centre.
  const float row_weight[3] = {0.5f * (1.0f - b) * (1.0f - b), 0.75f - (b - 0.5f) * (b - 0.5f), 0.5f * b * b};
  const float* const taps = padded_.data() + static_cast<std::size_t>(j) * stride_ + i;
  float across[4];  // Four, not three: a row is one load of four floats.
  for (int k = 0; k < 4; ++k)
    across[k] = row_weight[0] * taps[k] + row_weight[1] * taps[stride_ + k] + row_weight[2] * taps[2 * stride_ + k];
  const float left = 0.5f * (1.0f - a) * (1.0f - a), middle = 0.75f - (a - 0.5f) * (a - 0.5f), right = 0.5f * a * a;
  Sample sample{left * across[0] + middle * across[1] + right * across[2], 0.0f, 0.0f};
  if constexpr (Slopes) {
    float up[4];
    for (int k = 0; k < 4; ++k)
      up[k] = (1.0f - b) * (taps[stride_ + k] - taps[k]) + b * (taps[2 * stride_ + k] - taps[stride_ + k]);
    const auto per_metre = static_cast<float>(1.0 / period_);
    sample.du = ((1.0f - a) * (across[1] - across[0]) + a * (across[2] - across[1])) * static_cast<float>(width_) * per_metre;
    sample.dv = (left * up[0] + middle * up[1] + right * up[2]) * static_cast<float>(height_) * per_metre;
  }
  return sample;
}

}  // namespace outcrop

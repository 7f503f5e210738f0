#include "outcrop/implicit/relief.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

// Gaussian whose response is 1/e^2.2 = 0.11 to a wave as long as `length`, and 0.58 to one twice as long.
constexpr double kSigmaPerLength = 1.0 / 3.0;
constexpr int kBoxPasses = 3;

[[nodiscard]] int wrapped(int i, int n) { return ((i % n) + n) % n; }

/// One line of `count` values, periodic, filtered by a box of 2 radius + 1 samples and two of weight `edge` beside it.
void box_filter(const std::vector<double>& in, std::vector<double>& out, int radius, double edge) {
  const int n = static_cast<int>(in.size());
  const double scale = 1.0 / (2 * radius + 1 + 2.0 * edge);
  double sum = 0.0;
  for (int i = -radius; i <= radius; ++i) sum += in[wrapped(i, n)];
  for (int i = 0; i < n; ++i) {
    out[i] = scale * (sum + edge * (in[wrapped(i - radius - 1, n)] + in[wrapped(i + radius + 1, n)]));
    sum += in[wrapped(i + radius + 1, n)] - in[wrapped(i - radius, n)];
  }
}

/// Periodic Gaussian of `sigma` samples, by three boxes of the same variance in all.
void blur(std::vector<double>& line, double sigma) {
  const double variance = sigma * sigma / kBoxPasses;
  const int radius = static_cast<int>(0.5 * (std::sqrt(12.0 * variance + 1.0) - 1.0));
  const double edge = (2 * radius + 1) * (radius * (radius + 1.0) - 3.0 * variance) /
                      (6.0 * (variance - (radius + 1.0) * (radius + 1.0)));
  std::vector<double> other(line.size());
  for (int pass = 0; pass < kBoxPasses; ++pass) {
    box_filter(line, other, radius, edge);
    std::swap(line, other);
  }
}

}  // namespace

Relief::Relief(const Image& image, double period) : width_(image.width), height_(image.height), period_(period) {
  require(period > 0.0 && std::isfinite(period), "period", "> 0", period);
  require(image.width > 0 && image.height > 0 && image.channels > 0, "relief", "an image with pixels",
          std::to_string(image.width) + " x " + std::to_string(image.height));
  require((width_ + 4.0) * (height_ + 3.0) < 2147483648.0, "relief", "fewer than 2^31 pixels, the rim included",
          std::to_string(width_) + " x " + std::to_string(height_));
  std::vector<float> pixels(static_cast<std::size_t>(width_) * height_);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const double value = image.at(x, y) / image.full_scale;
      require(std::isfinite(value), "relief", "finite pixels", value);
      pixels[static_cast<std::size_t>(height_ - 1 - y) * width_ + x] = static_cast<float>(std::clamp(value, 0.0, 1.0));
    }
  finish(std::move(pixels));
}

void Relief::finish(std::vector<float> pixels) {
  // Two columns behind, not one: at_phase loads four taps, and a phase may round up to exactly 1.
  stride_ = width_ + 4;
  padded_.resize(static_cast<std::size_t>(stride_) * (height_ + 3));
  const auto pixel = [&](int i, int j) {
    return pixels[static_cast<std::size_t>(wrapped(j, height_)) * width_ + wrapped(i, width_)];
  };
  for (int j = 0; j < height_ + 3; ++j)
    for (int i = 0; i < stride_; ++i) padded_[static_cast<std::size_t>(j) * stride_ + i] = pixel(i - 1, j - 1);

  // Each derivative of a quadratic B-spline is a mean, with weights ≥ 0, of the differences between the 3 x 3 pixels it
  // sees.
  const auto near = [&](int i, int j) { return padded_[static_cast<std::size_t>(j + 1) * stride_ + i + 1]; };
  double steepest = 0.0;
  for (int j = 0; j < height_; ++j)
    for (int i = 0; i < width_; ++i) {
      double across = 0.0, up = 0.0;
      for (int k = -1; k <= 1; ++k)
        for (int l = 0; l <= 1; ++l) {
          across = std::max(across, std::abs(double{near(i + l, j + k)} - near(i + l - 1, j + k)));
          up = std::max(up, std::abs(double{near(i + k, j + l)} - near(i + k, j + l - 1)));
        }
      steepest = std::max(steepest, std::hypot(across * width_, up * height_));
    }
  slope_ = steepest / period_ * (1.0 + 1e-6);
}

Relief::Sample Relief::at(double u, double v) const noexcept {
  const double x = u / period_, y = v / period_;
  return at_phase(static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y)));
}

Relief::Sample Relief::at_phase(float u, float v) const noexcept {
  const float column = u * static_cast<float>(width_);
  const float row = v * static_cast<float>(height_);
  const int i = static_cast<int>(column);
  const int j = static_cast<int>(row);
  const float a = column - static_cast<float>(i),
              b = row - static_cast<float>(j);  // In [0, 1): ½ is the pixel's centre.
  const float left = 0.5f * (1.0f - a) * (1.0f - a), middle = 0.5f + a * (1.0f - a), right = 0.5f * a * a;
  const float below = 0.5f * (1.0f - b) * (1.0f - b), at = 0.5f + b * (1.0f - b), above = 0.5f * b * b;
  const float* const taps = padded_.data() + static_cast<std::ptrdiff_t>(j) * stride_ + i;
  float across[3], up[3];
  for (int k = 0; k < 3; ++k) {
    const float low = taps[k], mid = taps[stride_ + k], high = taps[2 * stride_ + k];
    across[k] = below * low + at * mid + above * high;
    up[k] = (1.0f - b) * (mid - low) + b * (high - mid);
  }
  const auto u_scale = static_cast<float>(width_ / period_), v_scale = static_cast<float>(height_ / period_);
  return {left * across[0] + middle * across[1] + right * across[2],
          u_scale * ((1.0f - a) * (across[1] - across[0]) + a * (across[2] - across[1])),
          v_scale * (left * up[0] + middle * up[1] + right * up[2])};
}

double Relief::mean() const noexcept {
  double sum = 0.0;
  for (int j = 0; j < height_; ++j)
    for (int i = 0; i < width_; ++i) sum += padded_[static_cast<std::size_t>(j + 1) * stride_ + i + 1];
  return sum / width_ / height_;
}

Relief Relief::smoothed(double length) const {
  require(length >= 0.0 && std::isfinite(length), "length", ">= 0 and finite", length);
  // Beyond a few periods a wider filter changes nothing but its cost.
  const double sigma = kSigmaPerLength * std::min(length, 6.0 * period_) / period_;
  std::vector<float> pixels(static_cast<std::size_t>(width_) * height_);
  std::vector<double> line(width_);
  for (int j = 0; j < height_; ++j) {
    const float* const row = padded_.data() + static_cast<std::size_t>(j + 1) * stride_ + 1;
    line.assign(row, row + width_);
    blur(line, sigma * width_);
    std::copy(line.begin(), line.end(), pixels.begin() + static_cast<std::ptrdiff_t>(j) * width_);
  }
  line.resize(height_);
  for (int i = 0; i < width_; ++i) {
    for (int j = 0; j < height_; ++j) line[j] = pixels[static_cast<std::size_t>(j) * width_ + i];
    blur(line, sigma * height_);
    for (int j = 0; j < height_; ++j)
      pixels[static_cast<std::size_t>(j) * width_ + i] = static_cast<float>(std::clamp(line[j], 0.0, 1.0));
  }
  Relief result;
  result.width_ = width_;
  result.height_ = height_;
  result.period_ = period_;
  result.finish(std::move(pixels));
  return result;
}

ReliefPtr read_relief(const std::filesystem::path& path, double period) {
  return std::make_shared<const Relief>(read_image(path), period);
}

}  // namespace outcrop

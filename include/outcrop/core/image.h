/// Pictures in memory, read and written through OpenImageIO.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace outcrop {

/// A picture of floats, row 0 at its top (north), channels interleaved.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> pixels;                ///< width · height · channels values.
  std::vector<std::string> channel_names;   ///< One a channel: "R", "G", "B", "A", "Y", "depth.Z", …
  /// The largest value of the file's integer type (255, 65535, …), or 1 for floating-point files. Pixels are in the file's
  /// own units: a 16-bit sample of 1200 is 1200, never 1200 / 65535.
  double full_scale = 1.0;

  [[nodiscard]] float at(int x, int y, int channel = 0) const noexcept {
    return pixels[(static_cast<std::size_t>(y) * width + x) * channels + channel];
  }
  [[nodiscard]] float& at(int x, int y, int channel = 0) noexcept {
    return pixels[(static_cast<std::size_t>(y) * width + x) * channels + channel];
  }
};

/// Reads any format that OpenImageIO knows.
///
/// Integer samples keep their native values (OpenImageIO would scale them to 0..1).
/// @throws InputError `path: expected …, got …` for a missing, empty, truncated or foreign file, a directory, or no pixels.
[[nodiscard]] Image read_image(const std::filesystem::path& path);

/// Writes `.png` (8-bit, values 0..1 clamped) or `.exr` (32-bit float, named channels), atomically: see core/file.h.
/// @throws ParameterError for another extension or an empty image; SystemError when the file cannot be written.
void write_image(const std::filesystem::path& path, const Image& image);

}  // namespace outcrop

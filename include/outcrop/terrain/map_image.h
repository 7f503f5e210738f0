/// Images laid over a terrain: masks and geological maps.
#pragma once

#include <optional>
#include <string>

#include "outcrop/core/image.h"
#include "outcrop/terrain/heightfield.h"

namespace outcrop {

/// A picture that covers a terrain: row 0 is the north edge, the last column the east edge.
class MapImage {
 public:
  /// An image fits when it has as many pixels as the heightmap samples, each then a sample's, or when its pixels,
  /// spread over the terrain, are square to within one pixel of its sides.
  /// @return what would fit, in words; nothing when the image does.
  [[nodiscard]] static std::optional<std::string> misfit(const Image& image, const Heightfield& heightfield);

  /// @throws ParameterError when the image does not fit.
  MapImage(Image image, const Heightfield& heightfield);

  /// The first channel over the file's full scale, bilinear between the centres of pixels, constant beyond them.
  [[nodiscard]] double brightness(double x, double y) const noexcept;
  /// The pixel at a map position; beyond the border, the nearest.
  struct Pixel {
    int column, row;
  };
  [[nodiscard]] Pixel pixel(double x, double y) const noexcept;
  [[nodiscard]] const Image& image() const noexcept { return image_; }
  /// Edges of a pixel, metres.
  [[nodiscard]] Vec2 pixel_size() const noexcept { return size_; }

 private:
  /// Columns from the first pixel's centre eastwards and rows from it southwards.
  [[nodiscard]] Vec2 place(double x, double y) const noexcept;

  Image image_;
  Vec2 north_west_{0.0};  ///< Centre of the first pixel.
  Vec2 size_{1.0};
};

}  // namespace outcrop

#include "outcrop/terrain/map_image.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

bool has_the_samples(const Image& image, const Heightfield& heightfield) {
  return image.width == heightfield.grid().width && image.height == heightfield.grid().height;
}

std::string pixels(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

}  // namespace

std::optional<std::string> MapImage::misfit(const Image& image, const Heightfield& heightfield) {
  if (has_the_samples(image, heightfield)) return std::nullopt;
  const Vec2 extent = heightfield.hi() - heightfield.lo();
  const double width = image.height * extent.x / extent.y, height = image.width * extent.y / extent.x;
  if (std::abs(width - image.width) <= 1.0 || std::abs(height - image.height) <= 1.0) return std::nullopt;
  const ElevationGrid& grid = heightfield.grid();
  return "an image of the terrain's " + pixels(grid.width, grid.height) + " samples, or of its proportions, such as " +
         pixels(image.width, std::max(1, static_cast<int>(std::lround(height))));
}

MapImage::MapImage(Image image, const Heightfield& heightfield) : image_(std::move(image)) {
  if (const std::optional<std::string> wanted = misfit(image_, heightfield))
    require(false, "image", *wanted, pixels(image_.width, image_.height));
  const Vec2 lo = heightfield.lo(), hi = heightfield.hi();
  if (has_the_samples(image_, heightfield)) {
    size_ = {heightfield.grid().cell_x, heightfield.grid().cell_y};
    north_west_ = {lo.x, hi.y};
  } else {
    size_ = (hi - lo) / Vec2(image_.width, image_.height);
    north_west_ = {lo.x + 0.5 * size_.x, hi.y - 0.5 * size_.y};
  }
}

Vec2 MapImage::place(double x, double y) const noexcept {
  const Vec2 p = Vec2(x - north_west_.x, north_west_.y - y) / size_;
  return glm::clamp(p, Vec2(0.0), Vec2(image_.width - 1, image_.height - 1));
}

MapImage::Pixel MapImage::pixel(double x, double y) const noexcept {
  const Vec2 p = glm::round(place(x, y));
  return {static_cast<int>(p.x), static_cast<int>(p.y)};
}

double MapImage::brightness(double x, double y) const noexcept {
  const Vec2 p = place(x, y);
  const int column = std::min(static_cast<int>(p.x), std::max(image_.width - 2, 0));
  const int row = std::min(static_cast<int>(p.y), std::max(image_.height - 2, 0));
  const int east = std::min(column + 1, image_.width - 1), south = std::min(row + 1, image_.height - 1);
  const Vec2 t = p - Vec2(column, row);
  const auto mix = [](double a, double b, double share) { return a + share * (b - a); };
  return mix(mix(image_.at(column, row), image_.at(east, row), t.x),
             mix(image_.at(column, south), image_.at(east, south), t.x), t.y) /
         image_.full_scale;
}

}  // namespace outcrop

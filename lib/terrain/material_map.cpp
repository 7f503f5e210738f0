#include "outcrop/terrain/material_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "outcrop/terrain/distance_transform.h"

namespace outcrop {
namespace {

constexpr double kNodesPerPixel = 2.0;  // Borders run between pixels, on a node.
constexpr double kMostNodes = 16e6;     // Of all areas' rasters each.
constexpr float kFarthest = 1e4f;       // Metres; distances beyond are alike.

bool is_colour(const Image& image, const MapImage::Pixel& pixel, const std::vector<float>& colour) {
  for (std::size_t channel = 0; channel < colour.size(); ++channel)
    if (static_cast<int>(channel) >= image.channels ||
        image.at(pixel.column, pixel.row, static_cast<int>(channel)) != colour[channel])
      return false;
  return true;
}

}  // namespace

MaterialMap::MaterialMap(const MapImage& image, const Heightfield& heightfield, const std::vector<Entry>& entries) {
  const Vec2 lo = heightfield.lo(), extent = heightfield.hi() - lo;
  const double fine = std::min(image.pixel_size().x, image.pixel_size().y) / kNodesPerPixel;
  const double spacing = std::max(fine, std::sqrt(extent.x * extent.y / kMostNodes));
  const int width = std::max(2, static_cast<int>(std::ceil(extent.x / spacing)) + 1);
  const int height = std::max(2, static_cast<int>(std::ceil(extent.y / spacing)) + 1);
  std::vector<std::optional<Label>> nodes;
  nodes.reserve(static_cast<std::size_t>(width) * height);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const MapImage::Pixel pixel = image.pixel(lo.x + spacing * column, lo.y + spacing * row);
      const auto entry =
          std::ranges::find_if(entries, [&](const Entry& e) { return is_colour(image.image(), pixel, e.colour); });
      nodes.push_back(entry == entries.end() ? std::nullopt : std::optional(entry->material));
    }
  std::vector<std::optional<Label>> named{std::nullopt};
  for (const Entry& entry : entries)
    if (!std::ranges::count(named, std::optional(entry.material))) named.emplace_back(entry.material);
  auto areas = std::make_shared<std::vector<Area>>();
  for (const std::optional<Label>& material : named) {
    std::vector<char> inside(nodes.size()), outside(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      inside[i] = nodes[i] == material;
      outside[i] = !inside[i];
    }
    if (!std::ranges::count(inside, 1)) continue;
    std::vector<float> distance = distance_to_marked(width, height, Vec2(spacing), inside, kFarthest);
    const std::vector<float> depth = distance_to_marked(width, height, Vec2(spacing), outside, kFarthest);
    // Half a node from either side: the two areas' distances are each other's negatives between them.
    const float half = 0.5f * static_cast<float>(spacing);
    for (std::size_t i = 0; i < distance.size(); ++i) distance[i] = inside[i] ? half - depth[i] : distance[i] - half;
    areas->push_back({material, RasterLayer(width, height, lo, spacing, std::move(distance))});
  }
  areas_ = std::move(areas);
}

std::optional<Label> MaterialMap::at(double x, double y) const noexcept {
  if (!areas_) return std::nullopt;
  const Area* nearest = nullptr;
  double least = 0.0;
  for (const Area& area : *areas_) {
    const double distance = area.distance.at(x, y).h;
    if (nearest && distance >= least) continue;
    nearest = &area;
    least = distance;
  }
  return nearest ? nearest->material : std::nullopt;
}

const RasterLayer* MaterialMap::area(std::optional<Label> material) const noexcept {
  if (!areas_) return nullptr;
  const auto found = std::ranges::find(*areas_, material, &Area::material);
  return found == areas_->end() ? nullptr : &found->distance;
}

std::vector<Label> MaterialMap::materials() const {
  std::vector<Label> result;
  if (areas_)
    for (const Area& area : *areas_)
      if (area.material) result.push_back(*area.material);
  return result;
}

}  // namespace outcrop

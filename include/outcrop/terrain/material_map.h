/// A geological map: which material stands at a place, whatever the depth.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"
#include "outcrop/terrain/map_image.h"
#include "outcrop/terrain/raster_layer.h"

namespace outcrop {

/// Areas of materials on the ground, with their distances. Copies are cheap; the default-constructed map names none.
class MaterialMap {
 public:
  /// A colour of the image and what it stands for.
  struct Entry {
    std::vector<float> colour;  ///< In the file's own units: one number for the first channel, or three.
    Label material;
  };

  MaterialMap() = default;
  /// Pixels of no entry's colour name no material. Cost: O(nodes) an entry, four nodes a pixel.
  MaterialMap(const MapImage& image, const Heightfield& heightfield, const std::vector<Entry>& entries);

  [[nodiscard]] bool empty() const noexcept { return areas_ == nullptr; }
  [[nodiscard]] std::optional<Label> at(double x, double y) const noexcept;
  /// Signed horizontal distance to the area of a material, or, for none, to that where no material is named: negative
  /// inside. Null where there is no such area. At no place are two of a map's distances negative.
  [[nodiscard]] const RasterLayer* area(std::optional<Label> material) const noexcept;
  /// All materials that it names.
  [[nodiscard]] std::vector<Label> materials() const;

 private:
  struct Area {
    std::optional<Label> material;
    RasterLayer distance;
  };
  std::shared_ptr<const std::vector<Area>> areas_;
};

}  // namespace outcrop

/// What GeoTIFF and GDAL tags say about a raster: where it lies, how large its cells are, what stands for no data.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace outcrop::terrain {

/// The tags as they stand in the file; empty where a tag is missing or of another type than its definition.
/// @cite OGC 19-008r4, the GeoTIFF standard 1.1
struct GeotiffTags {
  std::vector<double> pixel_scale;     ///< 33550: map units a column and a row, and the scale of heights.
  std::vector<double> tie_points;      ///< 33922: column, row, level, x, y, z of each.
  std::vector<double> transformation;  ///< 34264: map from raster, 4 x 4, row-major.
  std::optional<std::string> nodata;   ///< 42113: GDAL's text of a number.
  std::optional<int> model_type;       ///< GeoKey 1024: 1 projected, 2 geographic, 3 geocentric.
  std::optional<int> raster_type;      ///< GeoKey 1025: 1 a pixel is an area, 2 a point.
  std::optional<int> linear_unit;      ///< GeoKey 3076: EPSG code of the map's unit of length.
  std::optional<int> vertical_unit;    ///< GeoKey 4099: EPSG code of the unit of heights.
};

/// The tags of the first picture in a TIFF file; nothing when it is no TIFF. Never prints.
[[nodiscard]] std::optional<GeotiffTags> read_geotiff_tags(const std::filesystem::path& path);

}  // namespace outcrop::terrain

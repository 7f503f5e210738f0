/// Readers of elevation files: EXR, TIFF and GeoTIFF, PNG, SRTM .hgt.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "outcrop/terrain/heightfield.h"

namespace outcrop {

/// What the caller knows better than the file.
struct HeightfieldOptions {
  std::optional<double> cell_size;  ///< Metres, 1e-4 to 1e6; overrides the file's tags.
  double height_scale = 1.0;        ///< Elevation = sample · scale + offset; ≠ 0, finite.
  double height_offset = 0.0;       ///< Metres.
};

/// A grid and what had to be assumed about it, one line each, for the caller to show ("3 channels: took the first, R").
struct HeightfieldFile {
  ElevationGrid grid;
  std::vector<std::string> notes;
};

/// Reads elevations in the file's own units (a 16-bit PNG sample of 1200 is 1200 m before scale and offset).
///
/// GeoTIFF: cell size, origin and nodata from tags 33550, 33922, 34264 and 42113, read as GDAL reads them: scale and
/// the first tie point win over the matrix, a negative vertical scale means north up all the same. Rasters whose matrix
/// lies south up or mirrored are turned; askew ones are refused; feet become metres. Geographic rasters (degrees) get metres a degree at the raster's middle latitude,
/// and their origin is longitude and latitude times those. SRTM .hgt: big-endian 16-bit, -32768 is nodata, the name
/// gives the corner. Without tags the cell is 1 m and the origin (0, 0). No data, besides NaN and the tag's value:
/// -9999, -32768, infinity and what lies beyond ±1e30. Elevations beyond ±1e6 m are refused.
/// @throws InputError `path: expected …, got …`; ParameterError for options out of bounds.
[[nodiscard]] HeightfieldFile read_heightfield(const std::filesystem::path& path,
                                               const HeightfieldOptions& options = {});

}  // namespace outcrop

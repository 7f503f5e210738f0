#include "outcrop/terrain/read_heightfield.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <system_error>
#include <utility>

#include "geodesy.h"
#include "geotiff_tags.h"
#include "outcrop/core/error.h"
#include "outcrop/core/image.h"
#include "read_hgt.h"

namespace outcrop {
namespace {

using terrain::GeotiffTags;
using Notes = std::vector<std::string>;

constexpr double kLargestElevation = 1e6;                  // Metres: that of any planet.
constexpr double kLeastCell = 1e-4, kLargestCell = 1e6;    // Metres.
constexpr const char* kCellBounds = "0.0001 to 1e6 m";
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Values that stand for no data by custom, without a tag: ESRI's, SRTM's and the extremes of float that tools write.
constexpr float kEsriNodata = -9999.0f;
constexpr float kSrtmNodata = -32768.0f;
constexpr float kExtreme = 1e30f;

// GeoKeys and EPSG codes, GeoTIFF 1.1 (OGC 19-008r4).
constexpr int kModelGeographic = 2;
constexpr int kRasterPixelIsPoint = 2;
constexpr int kMetre = 9001;
constexpr int kFoot = 9002;
constexpr int kUsSurveyFoot = 9003;

std::string format(const char* pattern, double a, double b = 0.0, double c = 0.0) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& expected, const std::string& got) {
  throw InputError(path.string() + ": expected " + expected + ", got " + got);
}

/// Metres a unit; 1 and a note for codes that are none of the common ones.
double metres_per_unit(std::optional<int> epsg, const std::string& what, Notes& notes) {
  if (!epsg || *epsg == kMetre) return 1.0;
  if (*epsg == kFoot || *epsg == kUsSurveyFoot) {
    notes.push_back(what + " in feet: turned into metres");
    return *epsg == kFoot ? 0.3048 : 1200.0 / 3937.0;
  }
  notes.push_back(what + " in the unit EPSG:" + std::to_string(*epsg) + ", which is unknown here: taken as metres");
  return 1.0;
}

std::optional<float> parsed_nodata(const std::string& text, Notes& notes) {
  const std::size_t first = text.find_first_not_of(" +");
  double value = 0.0;
  if (first != std::string::npos) {
    const auto [rest, error] = std::from_chars(text.data() + first, text.data() + text.size(), value);
    // GDAL writes -1.7976931348623157e+308 and -3.4028234663852886e+38 alike: in a float file both are the lowest
    // float.
    constexpr double kLargest = std::numeric_limits<float>::max();
    if (error == std::errc()) return static_cast<float>(std::clamp(value, -kLargest, kLargest));
  }
  notes.push_back("the nodata tag is no number: ignored");
  return std::nullopt;
}

/// Turns what means "no data" into NaN.
void mark_nodata(std::vector<float>& samples, std::optional<float> tagged, Notes& notes) {
  std::size_t esri = 0, srtm = 0, extreme = 0;
  for (float& v : samples) {
    if (std::isnan(v)) continue;
    if (!tagged || v != *tagged) {
      const bool by_custom = v == kEsriNodata || v == kSrtmNodata || !(std::abs(v) < kExtreme);
      if (!by_custom) continue;
      ++(v == kEsriNodata ? esri : v == kSrtmNodata ? srtm : extreme);
    }
    v = kNan;
  }
  const auto note = [&](std::size_t count, const char* value) {
    if (count > 0) notes.push_back(std::to_string(count) + " samples of " + value + ": taken as no data");
  };
  note(esri, "-9999");
  note(srtm, "-32768");
  note(extreme, "infinity or beyond 1e30");
}

void mirror_columns(ElevationGrid& grid) {
  for (int r = 0; r < grid.height; ++r) {
    const auto first = grid.elevations.begin() + static_cast<std::ptrdiff_t>(r) * grid.width;
    std::reverse(first, first + grid.width);
  }
}

void mirror_rows(ElevationGrid& grid) {
  for (int r = 0; r < grid.height / 2; ++r) {
    const auto north = grid.elevations.begin() + static_cast<std::ptrdiff_t>(r) * grid.width;
    const auto south = grid.elevations.begin() + static_cast<std::ptrdiff_t>(grid.height - 1 - r) * grid.width;
    std::swap_ranges(north, north + grid.width, south);
  }
}

/// x = a column + b row + x0, y = c column + d row + y0; columns and rows as the tags count them.
struct MapFromRaster {
  double a, b, x0, c, d, y0;
};

/// Scale and tie point win over a matrix, and a negative vertical scale is taken for a slip: so do GDAL and all that is
/// built on it, against the standard, and files are made to look right there.
std::optional<MapFromRaster> map_from_raster(const GeotiffTags& tags, Notes& notes) {
  const auto& s = tags.pixel_scale;
  const auto& t = tags.tie_points;
  const auto& m = tags.transformation;
  if (s.size() >= 2 && s[0] != 0.0 && s[1] != 0.0 && t.size() >= 6) {
    if (s[1] < 0.0) notes.emplace_back("the vertical pixel scale is negative: taken as north up, as GDAL does");
    const double down = std::abs(s[1]);
    return MapFromRaster{s[0], 0.0, t[3] - t[0] * s[0], 0.0, -down, t[4] + t[1] * down};
  }
  if (m.size() == 16) return MapFromRaster{m[0], m[1], m[3], m[4], m[5], m[7]};
  return std::nullopt;
}

/// Gives the grid its place and its cell size by the tags, north up. False when they say nothing of use.
/// @throws InputError for a raster that lies askew.
bool place(ElevationGrid& grid, const GeotiffTags& tags, const std::filesystem::path& path, Notes& notes) {
  const std::optional<MapFromRaster> found = map_from_raster(tags, notes);
  if (!found) {
    const auto& s = tags.pixel_scale;
    if (s.size() < 2 || !(s[0] > 0.0 && s[1] > 0.0)) return false;
    grid.cell_x = s[0];
    grid.cell_y = s[1];
    return std::isfinite(s[0]) && std::isfinite(s[1]);
  }
  const MapFromRaster& map = *found;
  const Vec2 cell{std::hypot(map.a, map.c), std::hypot(map.b, map.d)};
  if (!std::isfinite(cell.x) || !std::isfinite(cell.y) || cell.x <= 0.0 || cell.y <= 0.0) return false;
  if (!std::isfinite(map.x0) || !std::isfinite(map.y0)) return false;
  if (std::abs(map.b) + std::abs(map.c) > 1e-6 * std::min(cell.x, cell.y)) {
    fail(path, "a raster along its map's axes",
         format("rows that run %.4g degrees from the map's x axis, columns %.4g from its y axis; gdalwarp makes one that "
                "lies straight",
                degrees(std::atan2(map.c, map.a)), degrees(std::atan2(-map.b, -map.d))));
  }
  if (map.a < 0.0) mirror_columns(grid);
  if (map.d > 0.0) mirror_rows(grid);
  const double centre =
      tags.raster_type == kRasterPixelIsPoint ? 0.0 : 0.5;  // Of the first sample, in raster coordinates.
  const double west = map.x0 + map.a * (centre + (map.a < 0.0 ? grid.width - 1 : 0));
  const double south = map.y0 + map.d * (centre + (map.d < 0.0 ? grid.height - 1 : 0));
  const double north = south + (grid.height - 1) * cell.y;

  Vec2 metres(1.0);
  const bool degrees_fit = std::abs(south) <= 90.0 && std::abs(north) <= 90.0 && std::abs(west) <= 360.0;
  if (tags.model_type == kModelGeographic && degrees_fit) {
    const double middle = 0.5 * (south + north);
    metres = terrain::metres_per_degree(middle);
    notes.push_back(format("degrees turned into metres at latitude %.4f: map x = longitude x %.2f, y = latitude x %.2f",
                           middle, metres.x, metres.y));
  } else if (tags.model_type == kModelGeographic) {
    notes.push_back("the tags say degrees, but the coordinates are too large for them: taken as metres");
  } else {
    metres = Vec2(metres_per_unit(tags.linear_unit, "map coordinates", notes));
  }
  grid.cell_x = cell.x * metres.x;
  grid.cell_y = cell.y * metres.y;
  grid.origin = Vec2(west, south) * metres;
  grid.georeferenced = true;
  return true;
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

/// Any picture that can be read is taken, whatever its name; a file that cannot and has the name of something else is
/// told which formats there are.
Image read_elevation_image(const std::filesystem::path& path) {
  try {
    return read_image(path);
  } catch (const InputError&) {
    const std::string extension = lower_extension(path);
    for (const char* const known : {".exr", ".tif", ".tiff", ".png"}) {
      if (extension == known) throw;
    }
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) throw;
    fail(path, "elevations as .exr, .tif, .png or .hgt", extension.empty() ? "none of them" : extension);
  }
}

/// The first channel of a picture, with place and cell size where it is a GeoTIFF.
HeightfieldFile read_raster(const std::filesystem::path& path, bool cell_given) {
  Image image = read_elevation_image(path);
  HeightfieldFile file;
  ElevationGrid& grid = file.grid;
  grid.width = image.width;
  grid.height = image.height;
  if (image.channels == 1) {
    grid.elevations = std::move(image.pixels);
  } else {
    grid.elevations.resize(static_cast<std::size_t>(image.width) * image.height);
    for (std::size_t i = 0; i < grid.elevations.size(); ++i) grid.elevations[i] = image.pixels[i * image.channels];
    const std::string first = image.channel_names.empty() ? "" : ", " + image.channel_names.front();
    file.notes.push_back(std::to_string(image.channels) + " channels: took the first" + first);
  }
  if (image.full_scale == 255.0 || image.full_scale == 127.0) {
    file.notes.emplace_back("8 bits a sample: at most 256 different elevations, so slopes come in steps");
  }

  const GeotiffTags tags = terrain::read_geotiff_tags(path).value_or(GeotiffTags{});
  mark_nodata(grid.elevations, tags.nodata ? parsed_nodata(*tags.nodata, file.notes) : std::nullopt, file.notes);
  if (!place(grid, tags, path, file.notes) && !cell_given) file.notes.emplace_back("no cell size in the file: took 1 m");
  const double unit = metres_per_unit(tags.vertical_unit, "elevations", file.notes);
  if (unit != 1.0) {
    for (float& h : grid.elevations) h = static_cast<float>(h * unit);
  }
  return file;
}

void check(const HeightfieldOptions& options) {
  if (options.cell_size) {
    require(*options.cell_size >= kLeastCell && *options.cell_size <= kLargestCell, "cell_size", kCellBounds,
            *options.cell_size);
  }
  require(std::isfinite(options.height_scale) && options.height_scale != 0.0, "height_scale",
          "a finite number other than 0", options.height_scale);
  require(std::isfinite(options.height_offset), "height_offset", "a finite number", options.height_offset);
}

}  // namespace

HeightfieldFile read_heightfield(const std::filesystem::path& path, const HeightfieldOptions& options) {
  check(options);
  HeightfieldFile file =
      lower_extension(path) == ".hgt" ? terrain::read_hgt(path) : read_raster(path, options.cell_size.has_value());
  ElevationGrid& grid = file.grid;
  if (grid.width < 2 || grid.height < 2) {
    fail(path, "at least 2 x 2 samples", std::to_string(grid.width) + " x " + std::to_string(grid.height));
  }
  if (options.cell_size) grid.cell_x = grid.cell_y = *options.cell_size;
  for (const double cell : {grid.cell_x, grid.cell_y})
    if (!(cell >= kLeastCell && cell <= kLargestCell))
      fail(path, std::string("cells of ") + kCellBounds, format("%.4g m", cell));

  bool any = false;
  for (std::size_t i = 0; i < grid.elevations.size(); ++i) {
    float& h = grid.elevations[i];
    if (std::isnan(h)) continue;
    const double metres = h * options.height_scale + options.height_offset;
    if (!(std::abs(metres) <= kLargestElevation)) {
      fail(path, "elevations within ±1e6 m",
           format("%.9g m in column %.0f, row %.0f", metres, static_cast<double>(i % grid.width),
                  static_cast<double>(i / grid.width)));
    }
    h = static_cast<float>(metres);
    any = true;
  }
  if (!any) fail(path, "elevations", "no data in every sample");
  return file;
}

}  // namespace outcrop

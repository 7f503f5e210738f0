#include "read_hgt.h"

#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include "geodesy.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"

namespace outcrop::terrain {
namespace {

constexpr int kVoid = -32768;  // SRTM Topography, USGS 2006, section 3.0: voids.

/// Longitude and latitude of the south-western corner in a name that begins like "N37W120".
std::optional<Vec2> corner_in_name(const std::string& name) {
  if (name.size() < 7) return std::nullopt;
  for (const std::size_t i : {1, 2, 4, 5, 6}) {
    if (!std::isdigit(static_cast<unsigned char>(name[i]))) return std::nullopt;
  }
  const int ns = std::toupper(static_cast<unsigned char>(name[0]));
  const int ew = std::toupper(static_cast<unsigned char>(name[3]));
  if ((ns != 'N' && ns != 'S') || (ew != 'E' && ew != 'W')) return std::nullopt;
  const double latitude = std::stoi(name.substr(1, 2)), longitude = std::stoi(name.substr(4, 3));
  return Vec2(ew == 'E' ? longitude : -longitude, ns == 'N' ? latitude : -latitude);
}

}  // namespace

HeightfieldFile read_hgt(const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  const std::size_t samples = bytes.size() / 2;
  const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(samples))));
  if (side < 2 || bytes.size() != 2 * static_cast<std::size_t>(side) * side) {
    throw InputError(path.string() + ": expected n x n 16-bit samples (1201 or 3601 a side), got " +
                     std::to_string(bytes.size()) + " bytes");
  }

  HeightfieldFile file;
  ElevationGrid& grid = file.grid;
  grid.width = grid.height = side;
  grid.elevations.resize(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const unsigned high = static_cast<unsigned char>(bytes[2 * i]), low = static_cast<unsigned char>(bytes[2 * i + 1]);
    const int value = static_cast<std::int16_t>(high << 8 | low);
    grid.elevations[i] = value == kVoid ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value);
  }

  const std::optional<Vec2> corner = corner_in_name(path.filename().string());
  const double latitude = corner ? corner->y + 0.5 : 0.0;
  const Vec2 degree = metres_per_degree(latitude);
  grid.cell_x = degree.x / (side - 1);
  grid.cell_y = degree.y / (side - 1);
  grid.georeferenced = corner.has_value();
  if (corner) {
    grid.origin = *corner * degree;
    char note[160];
    std::snprintf(note, sizeof note,
                  "degrees turned into metres at latitude %.4g: map x = longitude x %.2f, y = latitude x %.2f",
                  latitude, degree.x, degree.y);
    file.notes.emplace_back(note);
  } else {
    file.notes.emplace_back("the file's name gives no corner (as N37W120.hgt does): cell size taken at the equator");
  }
  return file;
}

}  // namespace outcrop::terrain

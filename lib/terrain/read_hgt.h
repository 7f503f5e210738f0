/// Tiles of the Shuttle Radar Topography Mission.
#pragma once

#include <filesystem>

#include "outcrop/terrain/read_heightfield.h"

namespace outcrop::terrain {

/// Reads an SRTM `.hgt` tile: nothing but n x n elevations, big-endian signed 16-bit metres, rows from the north.
///
/// A tile covers one degree with samples on its borders (n = 1201 or 3601; any n ≥ 2 is taken). -32768 is no data. The
/// file's name, "N37W120.hgt", gives its south-western corner; other names give the cell at the equator, and a note.
/// @throws InputError when the size is not that of a square.
[[nodiscard]] HeightfieldFile read_hgt(const std::filesystem::path& path);

}  // namespace outcrop::terrain

/// The report on one tile: a page that a geologist can read, and its numbers as JSON.
#pragma once

#include <string>
#include <vector>

#include "outcrop/fracture/classify.h"
#include "outcrop/fracture/rock_statistics.h"
#include "outcrop/fracture/tile.h"

namespace outcrop {

class JsonWriter;

/// What a report says about one tile.
struct TileReport {
  std::string title = "Rock";      ///< The material's name.
  std::vector<std::string> notes;  ///< Lines under the title: what was asked for, seed, targets.
  BlockType asked = BlockType::Equidimensional;
  Mat3 map_from_tile{1.0};  ///< Turns orientations into the map's axes for the table and the stereonet.
  RockStatistics statistics;
  Classification found;
};

/// Measures and classifies a tile. Cost: as measure_rock and classify.
/// @param map_from_tile  How the tile lies in the map, a rotation: means of sets are reported there.
[[nodiscard]] TileReport tile_report(const Tile& tile, std::string title, std::vector<std::string> notes,
                                     const Mat3& map_from_tile = Mat3(1.0), const Task& task = {});

/// One page as SVG, 1000 x 1414 pixels: picture of the blocks, stereonet (poles, equal area, lower hemisphere), volume
/// distribution by number and by volume, shape diagram, a horizontal trace map, and tables of the numbers.
[[nodiscard]] std::string tile_figure_svg(const Tile& tile, const TileReport& report);
/// The same as a self-contained HTML page; several tiles make several pages.
[[nodiscard]] std::string tile_figure_html(const std::vector<std::string>& svg_pages, const std::string& title);

/// Writes the members of an open JSON object: what was asked, what was measured, what was found. docs/formats.md.
void write_tile_report(JsonWriter& json, const TileReport& report);

}  // namespace outcrop

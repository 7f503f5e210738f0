/// The parts of a tile's page; each draws into a rectangle of the picture.
#pragma once

#include <string>

#include "outcrop/fracture/tile_figure.h"
#include "rock_cells.h"
#include "tile_figure_svg.h"

namespace outcrop {

/// Where a panel is drawn: its upper left corner and size, pixels.
struct Frame {
  Vec2 corner{0.0}, size{0.0};
};

/// The colour of a joint set, or of a group of joints without one; six sets have their own, then they repeat.
[[nodiscard]] std::string_view set_colour(int set);

/// Blocks as made, seen from above and the south-south-east of the tile, faces coloured by joint set; a scale bar.
void draw_blocks(Svg& svg, const Frame& frame, const Tile& tile, const Mat3& map_from_tile);
/// Poles of joints (equal area, lower hemisphere), means of sets with their planes.
void draw_stereonet(Svg& svg, const Frame& frame, const Tile& tile, const RockCells& rock, const TileReport& report);
/// Share of blocks, and of rock, in blocks smaller than a volume.
void draw_volumes(Svg& svg, const Frame& frame, const RockStatistics& rock);
/// Elongation against flatness of each block, with Palmström's β.
void draw_shapes(Svg& svg, const Frame& frame, const RockStatistics& rock);
/// Traces of joints on a plane along the bedding through the tile's middle; an arrow to the map's north.
void draw_traces(Svg& svg, const Frame& frame, const Tile& tile, const RockCells& rock, const Mat3& map_from_tile);

}  // namespace outcrop

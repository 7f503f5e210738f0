#include "outcrop/fracture/tile_figure.h"

#include <gtest/gtest.h>

#include <string>

#include "fracture/hand_tiles.h"
#include "outcrop/core/json.h"
#include "outcrop/core/parallel.h"

namespace outcrop {
namespace {

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST(TileFigure, IsOnePageForEveryTypeWithoutABrokenNumber) {
  for (const BlockType type : kBlockTypes) {
    const Tile tile = make_tile({.type = type, .spacing = 1.0}, 2);
    const TileReport report = tile_report(tile, std::string(name(type)), {"a note"});
    const std::string svg = tile_figure_svg(tile, report);
    EXPECT_EQ(count(svg, "<svg "), 1u);
    EXPECT_EQ(count(svg, "</svg>"), 1u);
    for (const char* broken : {"nan", "inf\"", "-inf", "e+"}) EXPECT_EQ(count(svg, broken), 0u) << name(type) << broken;
    for (const SetStatistics& set : report.statistics.sets) EXPECT_GE(count(svg, ">" + set.name + "<"), 1u) << set.name;
    EXPECT_GE(count(svg, "<circle"), tile.blocks.size());  // a dot a block in the shape diagram
    EXPECT_EQ(count(svg, "a note"), 1u);
  }
}

TEST(TileFigure, EscapesWhatMaterialsAreCalled) {
  const Tile tile =
      test::grid_tile(4.0, {test::even_places(4.0, 2), test::even_places(4.0, 2), test::even_places(4.0, 2)}, 0.01);
  const std::string svg = tile_figure_svg(tile, tile_report(tile, "<b> & \"c\"\n", {}));
  EXPECT_EQ(count(svg, "<b>"), 0u);
  EXPECT_GE(count(svg, "&lt;b&gt; &amp; &quot;c&quot;<"), 2u);
}

TEST(TileFigure, ShowsTheFrontFacesOfBlocksOnce) {
  // Eight boxes: three faces of each turn to the viewer.
  const Tile tile =
      test::grid_tile(4.0, {test::even_places(4.0, 2), test::even_places(4.0, 2), test::even_places(4.0, 2)}, 0.01);
  EXPECT_EQ(count(tile_figure_svg(tile, tile_report(tile, "boxes", {})), "<polygon"), 24u);
}

TEST(TileFigure, IsTheSameOnOneThreadAndFour) {
  const Tile tile = make_tile({.type = BlockType::Columnar, .spacing = 1.2}, 1);
  std::string pages[2];
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    pages[threads / 4] = tile_figure_svg(tile, tile_report(tile, "columns", {}));
  }
  EXPECT_EQ(pages[0], pages[1]);
}

TEST(TileFigure, NumbersAreThoseOfThePage) {
  const Tile tile = make_tile({.type = BlockType::Tabular, .spacing = 1.0}, 6);
  const TileReport report = tile_report(tile, "slate", {});
  JsonWriter writer;
  writer.begin_object();
  write_tile_report(writer, report);
  const Json json = parse_json(writer.end_object().text(), "report");
  JsonReader reader(json);
  EXPECT_EQ(reader.string("name", ""), "slate");
  EXPECT_EQ(reader.string("block_type", ""), "tabular");
  EXPECT_EQ(reader.number("tile_blocks", 0), static_cast<double>(tile.blocks.size()));
  EXPECT_EQ(reader.number("jv", 0), report.statistics.jv);
  EXPECT_EQ(reader.array("joint_sets").size(), report.statistics.sets.size());
  JsonReader found(*reader.child("found"));
  EXPECT_EQ(found.string("block_type", ""), name(report.found.type));
}

}  // namespace
}  // namespace outcrop

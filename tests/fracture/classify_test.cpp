#include "outcrop/fracture/classify.h"

#include <gtest/gtest.h>

#include "fracture/hand_tiles.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

constexpr Seed kSeeds[] = {101, 102, 103};  // bench/classify_types.cpp judges a hundred.

Tile boxes(int across_x, int across_y, int across_z) {
  return test::grid_tile(12.0,
                         {test::random_places(12.0, across_x, 1, "x"), test::random_places(12.0, across_y, 1, "y"),
                          test::random_places(12.0, across_z, 1, "z")},
                         0.01);
}

TEST(Classify, GivesBackTheTypeThatWasAskedFor) {
  for (const BlockType type : kBlockTypes)
    for (const Seed seed : kSeeds)
      EXPECT_EQ(name(classify(make_tile({.type = type}, seed)).type), name(type)) << "seed " << seed;
}

TEST(Classify, LooksAtNothingButTheBlocks) {
  for (const BlockType type : kBlockTypes) {
    Tile tile = make_tile({.type = type}, 101);
    tile.type = type == BlockType::Tabular ? BlockType::Columnar : BlockType::Tabular;
    tile.discs.clear();
    tile.sets.clear();
    EXPECT_EQ(name(classify(tile).type), name(type));
  }
}

TEST(Classify, KnowsBoxesByWhatTheirSidesHaveInCommon) {
  EXPECT_EQ(classify(boxes(6, 6, 6)).type, BlockType::Equidimensional);
  EXPECT_EQ(classify(boxes(8, 3, 8)).type, BlockType::Prismatic);
  EXPECT_EQ(classify(boxes(3, 12, 3)).type, BlockType::Tabular);
}

TEST(Classify, DoesNotMindTheSize) {
  for (const double side : {2.0, 300.0}) {
    const double scale = side / 20.0;
    const TileOptions options{
        .type = BlockType::Rhombohedral, .side = side, .aperture = 0.04 * scale, .rounding = 0.25 * scale};
    const Classification c = classify(make_tile(options, 7));
    const Classification at_20 = classify(make_tile({.type = BlockType::Rhombohedral}, 7));
    EXPECT_EQ(c.type, at_20.type);
    EXPECT_NEAR(c.fabric_flatness, at_20.fabric_flatness, 1e-3);
  }
}

TEST(Classify, ATileWithoutBlocksIsRefused) { EXPECT_THROW((void)classify({}), ParameterError); }

}  // namespace
}  // namespace outcrop

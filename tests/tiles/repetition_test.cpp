#include <gtest/gtest.h>

#include "wall_relief.h"

namespace outcrop {
namespace {

constexpr double kMost = 0.15;

// The mean of four walls' autocorrelations, the greatest over the lags `first`, `first` + 1 tile, … up to 100 m.
double repetition(const Tile& tile, double first) {
  std::vector<test::WallRelief> walls;
  for (const bool along_y : {false, true})
    for (const double offset : {3.0, 13.0}) walls.push_back(test::wall_relief(tile, {.along_y = along_y, .offset = offset}, 0.5));
  double most = -1.0;
  for (double lag = first * tile.side; lag <= 100.0; lag += tile.side) {
    double mean = 0.0;
    for (const test::WallRelief& wall : walls) mean += wall.autocorrelation(lag) / static_cast<double>(walls.size());
    most = std::max(most, mean);
  }
  return most;
}

TEST(Repetition, IsNotInTheReliefOfAWallOfVariants) {
  for (const BlockType type : kBlockTypes) {
    // Beds run on, at any lag: there the multiples of the tile are no different from what lies between them.
    const Tile tile = make_tile({.type = type, .variants = 8}, 1);
    const double trend = type == BlockType::Tabular ? repetition(tile, 1.5) : 0.0;
    EXPECT_LT(repetition(tile, 1.0), kMost + trend) << name(type);
  }
}

TEST(Repetition, IsWholeInTheReliefOfAWallOfOneTile) {
  EXPECT_GT(repetition(make_tile({.type = BlockType::Rhombohedral}, 1), 1.0), 0.999);
}

}  // namespace
}  // namespace outcrop

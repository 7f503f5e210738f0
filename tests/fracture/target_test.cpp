#include "outcrop/fracture/target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "outcrop/core/error.h"
#include "outcrop/fracture/classify.h"
#include "outcrop/fracture/rock_statistics.h"

namespace outcrop {
namespace {

TileOptions rock_of(BlockType type) { return {.type = type, .side = 20.0, .spacing = 1.0}; }  // coarse: fast

// What is reached is measured on a tile that is made anew with the options found.
TEST(Target, EveryTypeReachesThreeBlockVolumes) {
  for (const BlockType type : kBlockTypes)
    for (const double volume : {0.05, 2.5, 400.0}) {
      const TargetedTile fitted = fit_tile(rock_of(type), {.block_volume = volume}, 3);
      const Tile tile = make_tile(fitted.options, 3);
      EXPECT_NEAR(measure_rock(tile).volume_mean / volume, 1.0, 0.15) << name(type) << ", " << fitted.note;
      EXPECT_EQ(name(classify(tile).type), name(type)) << volume;
      EXPECT_TRUE(fitted.is_met);
    }
}

TEST(Target, EveryTypeReachesThreeJointCounts) {
  for (const BlockType type : kBlockTypes)
    for (const double jv : {0.5, 4.0, 25.0}) {
      const TargetedTile fitted = fit_tile(rock_of(type), {.jv = jv}, 4);
      EXPECT_NEAR(measure_rock(make_tile(fitted.options, 4)).jv / jv, 1.0, 0.1) << name(type) << ", " << fitted.note;
    }
}

TEST(Target, RqdIsReachedByItsJointCount) {
  const TargetedTile fitted = fit_tile(rock_of(BlockType::Tabular), {.rqd = 75.0}, 1);
  EXPECT_NEAR(fitted.rqd, 75.0, 1e-9);
  EXPECT_NEAR(measure_rock(make_tile(fitted.options, 1)).rqd_2005, 75.0, 3.5);
}

TEST(Target, OwnJointSetsKeepTheirProportions) {
  TileOptions options = rock_of(BlockType::Equidimensional);
  options.pattern = joint_pattern(BlockType::Equidimensional, options.side);
  options.pattern.sets[2].radius_hi = options.pattern.sets[2].radius_lo = 15.0;
  const TargetedTile fitted = fit_tile(options, {.block_volume = 1.0}, 5);
  EXPECT_NEAR(fitted.options.pattern.sets[2].radius_lo / fitted.options.side, 15.0 / 20.0, 1e-12);
  EXPECT_NEAR(fitted.options.spacing / fitted.options.side, 1.0 / 20.0, 1e-12);
  EXPECT_NEAR(measure_rock(make_tile(fitted.options, 5)).volume_mean, 1.0, 0.15);
}

TEST(Target, ContradictionsGetTheNearestInOneLine) {
  const TargetedTile fitted = fit_tile(rock_of(BlockType::Prismatic), {.block_volume = 1.0, .jv = 20.0}, 1);
  EXPECT_FALSE(fitted.is_met);
  EXPECT_NE(fitted.note.find("cannot have all of it, this is the nearest"), std::string::npos) << fitted.note;
  EXPECT_EQ(fitted.note.find('\n'), std::string::npos);
  EXPECT_LT(fitted.block_volume, 1.0);
  EXPECT_LT(fitted.jv, 20.0);
  // Neither wish is nearer than the other, in lengths.
  EXPECT_NEAR(std::cbrt(fitted.block_volume), fitted.jv / 20.0, 1e-9);
  const TargetedTile huge = fit_tile(rock_of(BlockType::Prismatic), {.block_volume = 1e9}, 1);
  EXPECT_FALSE(huge.is_met);
  EXPECT_NEAR(huge.options.side, 1000.0, 1e-9);
}

TEST(Target, WhatIsNoTargetIsRefused) {
  const TileOptions options = rock_of(BlockType::Tabular);
  EXPECT_THROW((void)fit_tile(options, {}, 1), ParameterError);
  EXPECT_THROW((void)fit_tile(options, {.block_volume = 0.0}, 1), ParameterError);
  EXPECT_THROW((void)fit_tile(options, {.jv = -1.0}, 1), ParameterError);
  EXPECT_THROW((void)fit_tile(options, {.rqd = 101.0}, 1), ParameterError);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/tiles/finer_joints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "implicit/field_contract.h"
#include "outcrop/core/error.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/tiles/replication.h"

namespace outcrop {
namespace {

constexpr double kDepth = 0.15;
const Box kRegion{Vec3(-5.0), Vec3(5.0)};

/// Blocks of about a fifth of `side` everywhere, their cracks closed below z = −2.
FieldPtr blocks(double side, double aperture, Seed seed) {
  Tile tile = make_tile({.side = side, .aperture = aperture, .rounding = 0.01 * side}, seed);
  return std::make_shared<Replication>(
      Rock{.tile = std::move(tile), .label = static_cast<Label>(seed)}, half_space({}),
      ReplicationOptions{.domain = kRegion.grown(1.0),
                         .crack_floor = half_space({.normal = {0, 0, 1}, .offset = 2.0}),
                         .closure = 0.01 * side,
                         .cap = 0.02 * side});
}

struct BlocksOfBlocks {
  FieldPtr rock = blocks(8.0, 0.06, 1), finer = blocks(1.6, 0.03, 2);
  FieldPtr both = with_finer_joints(rock, finer, kDepth);
};

TEST(FinerJoints, PassTheFieldContract) {
  const BlocksOfBlocks blocks;
  test::check_field_contract(*blocks.both, kRegion, 4);
}

TEST(FinerJoints, OnlyTakeRockAwayNearItsSurfaceAndWhereTheFinerRockIsAir) {
  const BlocksOfBlocks blocks;
  Rng rng(1, "finer joints");
  int taken = 0;
  for (int i = 0; i < 30'000; ++i) {
    const Vec3 p = test::random_point(rng, kRegion);
    const double rock = blocks.rock->value(p), finer = blocks.finer->value(p), both = blocks.both->value(p);
    ASSERT_EQ(both, std::max(rock, std::min(finer, rock + kDepth)));
    taken += both >= 0.0 && rock < 0.0;
  }
  EXPECT_GT(taken, 100);
}

TEST(FinerJoints, LeaveTheInsideOfBlocksWhole) {
  const FieldPtr rock = half_space({.normal = {0, 0, 1}, .offset = 0.0});
  const FieldPtr both = with_finer_joints(rock, blocks(1.6, 0.03, 2), kDepth);
  const auto cube = [](const Vec3& middle, double side) { return Box{middle - 0.5 * side, middle + 0.5 * side}; };
  Rng rng(2, "finer joints");
  int open = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = rng.uniform(-4.0, 4.0);
    const double y = rng.uniform(-4.0, 4.0);
    ASSERT_LT(both->bound(cube({x, y, -kDepth - 0.02}, 0.02)).hi, 0.0);
    ASSERT_LT(both->bound(cube({x, y, -2.0}, 1.0)).hi, 0.0);
    open += both->value({x, y, -kDepth + 0.02}) >= 0.0;
  }
  EXPECT_GT(open, 20) << "of 2000 points just less deep";
}

TEST(FinerJoints, RefuseWhatTheyCannotUse) {
  EXPECT_THROW((void)with_finer_joints(nullptr, half_space({}), 1.0), ParameterError);
  EXPECT_THROW((void)with_finer_joints(half_space({}), half_space({}), 0.0), ParameterError);
}

}  // namespace
}  // namespace outcrop

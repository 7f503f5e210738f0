#include "outcrop/tiles/replication.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "implicit/field_contract.h"
#include "implicit/shapes.h"
#include "outcrop/core/parallel.h"
#include "outcrop/implicit/primitives.h"

namespace outcrop {
namespace {

const Tile& granite() {
  static const Tile tile = make_tile({.type = BlockType::Rhombohedral, .side = 8.0, .spacing = 0.5, .aperture = 0.04, .rounding = 0.1}, 7);
  return tile;
}

Mat3 about_z(double angle) {
  return {Vec3(std::cos(angle), std::sin(angle), 0.0), Vec3(-std::sin(angle), std::cos(angle), 0.0), Vec3(0.0, 0.0, 1.0)};
}

std::shared_ptr<Replication> replicate(ReplicationOptions options, double angle = 0.0, Vec3 origin = Vec3(0.0),
                                       FieldPtr terrain = half_space({})) {
  return std::make_shared<Replication>(
      Rock{.tile = granite(), .label = 3, .world_from_tile = about_z(angle), .origin = origin}, std::move(terrain),
      std::move(options));
}

const Box kDomain{Vec3(-20.0), Vec3(20.0)};

TEST(Replication, PassesTheFieldContract) {
  test::check_field_contract(*replicate({.domain = kDomain}, 0.4), {Vec3(-9.0), Vec3(9.0)});
}

TEST(Replication, WithClosingCracksPassesTheFieldContract) {
  const auto node = replicate({.domain = kDomain, .crack_floor = half_space({.normal = {0, 0, 1}, .offset = 1.0}), .closure = 0.3,
                               .swelling = 0.01},
                              1.1);
  test::check_field_contract(*node, {Vec3(-9.0), Vec3(9.0)});
}

TEST(Replication, WithAReliefPassesTheFieldContract) {
  const Warp warp{test::noise_relief(1, 64, 64, 4.0), 0.05};
  const auto node = std::make_shared<Replication>(
      Rock{.tile = granite(), .warp = warp, .world_from_tile = about_z(0.4)}, half_space({}),
      ReplicationOptions{.domain = kDomain, .crack_floor = half_space({.normal = {0, 0, 1}, .offset = 1.0}),
                         .closure = 0.1});
  test::check_field_contract(*node, {Vec3(-9.0), Vec3(9.0)}, 4);
}

TEST(Replication, OfVariantsPassesTheFieldContract) {
  const Tile tile = make_tile(
      {.type = BlockType::Tabular, .side = 8.0, .spacing = 0.5, .aperture = 0.04, .rounding = 0.1, .variants = 3}, 7);
  const auto node = std::make_shared<Replication>(
      Rock{.tile = tile, .warp = {test::noise_relief(1, 64, 64, 4.0), 0.05}, .world_from_tile = about_z(0.4)}, half_space({}),
      ReplicationOptions{.domain = kDomain, .criterion = distance_between(-100.0, 3.0)});
  test::check_field_contract(*node, {Vec3(-9.0), Vec3(9.0)}, 4);
}

TEST(Replication, RepeatsWithThePeriodOfTheTile) {
  const auto node = replicate({.domain = kDomain});
  Rng rng(1, "replication test");
  for (int i = 0; i < 2000; ++i) {
    const double x = rng.uniform(-8, 0);
    const double y = rng.uniform(-8, 0);
    const double z = rng.uniform(-8, 0);
    const Vec3 p(x, y, z);
    for (const Vec3& shift : {Vec3(8, 0, 0), Vec3(0, 8, 0), Vec3(8, 8, 8)}) EXPECT_NEAR(node->value(p), node->value(p + shift), 1e-5);
  }
}

TEST(Replication, EqualsTheMinimumOverAllBlocksAndCopies) {
  const double cap = 0.4;
  const auto node = replicate({.domain = kDomain, .cap = cap});
  std::vector<FieldPtr> blocks;
  for (const Block& block : granite().blocks)
    for (int i = 0; i < 27; ++i) {
      const Vec3 centre = block.centre + 8.0 * Vec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      blocks.push_back(std::make_shared<RoundedPolytope>(PolytopeKernel(block.planes, block.rounding, {}, block.centre), centre));
    }
  Rng rng(2, "replication test");
  for (int i = 0; i < 300; ++i) {
    const double x = rng.uniform(0, 8);
    const double y = rng.uniform(0, 8);
    const double z = rng.uniform(0, 8);
    double expected = cap;
    for (const FieldPtr& block : blocks) expected = std::min(expected, block->value({x, y, z}));
    ASSERT_NEAR(node->value({x, y, z}), expected, 1e-5);
  }
}

TEST(Replication, AnAbsentBlockIsNotThere) {
  const auto none = replicate({.domain = kDomain, .criterion = [](const Anchor&) { return false; }, .cap = 0.25});
  EXPECT_EQ(none->block_count(), 0u);
  EXPECT_EQ(none->value({1, 2, 3}), 0.25);
  EXPECT_EQ(none->bound({Vec3(0.0), Vec3(1.0)}).lo, 0.25);
}

TEST(Replication, KeepsBlocksWithHalfOrMoreOfTheirAnchorsInRock) {
  const auto node = replicate({.domain = kDomain, .criterion = distance_between(-100.0, 0.0)});
  const Tile& tile = granite();
  for (std::size_t b = 0; b < tile.blocks.size(); ++b)
    for (int z = -2; z <= 1; ++z) {
      std::size_t inside = 0;
      for (const Vec3& anchor : tile.blocks[b].anchors) inside += tile.blocks[b].centre.z + anchor.z + 8.0 * z <= 0.0;
      EXPECT_EQ(node->block_present({0, 0, z}, b), 2 * inside >= tile.blocks[b].anchors.size()) << "block " << b << " cell " << z;
    }
}

TEST(Replication, CracksAreClosedBelowTheirFloor) {
  // Far below the floor every point of the lattice is rock, edges and corners between blocks included.
  const auto open = replicate({.domain = kDomain});
  const auto closed = replicate({.domain = kDomain, .crack_floor = half_space({.normal = {0, 0, 1}, .offset = -100.0}), .closure = 0.3});
  Rng rng(3, "replication test");
  int air_when_open = 0, air_when_closed = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = rng.uniform(-8, 8);
    const double y = rng.uniform(-8, 8);
    const double z = rng.uniform(-8, 8);
    air_when_open += open->value({x, y, z}) > 0.0;
    air_when_closed += closed->value({x, y, z}) > 0.0;
  }
  EXPECT_GT(air_when_open, 300);
  EXPECT_LE(air_when_closed, air_when_open / 20);
}

TEST(Replication, IsTheSameForAnyNumberOfThreads) {
  const auto place = [](int threads) {
    const ThreadLimit limit(threads);
    return replicate({.domain = kDomain, .criterion = distance_between(-3.0, 0.0)}, 0.7);
  };
  const auto one = place(1), two = place(2);
  ASSERT_EQ(one->block_count(), two->block_count());
  Rng rng(4, "replication test");
  for (int i = 0; i < 500; ++i) {
    const double x = rng.uniform(-9, 9);
    const double y = rng.uniform(-9, 9);
    const double z = rng.uniform(-9, 9);
    ASSERT_EQ(one->value({x, y, z}), two->value({x, y, z}));
  }
}

TEST(Replication, FarFromTheOriginIsTheSameRock) {
  const Vec3 far(5e6, 5e6, 0.0);
  const auto near_node = replicate({.domain = kDomain}, 0.4);
  const auto far_node = replicate({.domain = kDomain.moved(far)}, 0.4, far);
  Rng rng(5, "replication test");
  for (int i = 0; i < 500; ++i) {
    const double x = rng.uniform(-9, 9);
    const double y = rng.uniform(-9, 9);
    const double z = rng.uniform(-9, 9);
    ASSERT_NEAR(near_node->value({x, y, z}), far_node->value(Vec3(x, y, z) + far), 1e-6);
  }
}

TEST(Replication, WhatStandsAtALowWeightStandsAtAHigherOne) {
  const auto at = [](double weight) {
    return replicate({.domain = kDomain, .weight = [=](const Anchor&) { return weight; }, .seed = 5});
  };
  const auto all = replicate({.domain = kDomain}), most = at(0.8), few = at(0.2);
  EXPECT_EQ(at(1.0)->block_count(), all->block_count());
  EXPECT_EQ(at(0.0)->block_count(), 0u);
  const double count = static_cast<double>(all->block_count());
  EXPECT_NEAR(most->block_count() / count, 0.8, 0.05);
  EXPECT_NEAR(few->block_count() / count, 0.2, 0.05);
  for (std::size_t b = 0; b < granite().blocks.size(); ++b)
    for (int cell = -2; cell < 2; ++cell)
      EXPECT_LE(few->block_present({cell, 0, 1}, b), most->block_present({cell, 0, 1}, b));
}

TEST(Replication, OnlyTheAnchorsInItsBodyCount) {
  // A bed of one metre that passes through blocks, between their corners too, up to a wall at x = 0.
  const FieldPtr bed = slab(2.0, 3.0);
  const auto node = replicate({.domain = kDomain, .criterion = distance_between(-100.0, 0.0), .body = bed}, 0.0,
                              Vec3(0.0), half_space({.normal = {1, 0, 0}, .offset = 0.0}));
  for (std::size_t b = 0; b < granite().blocks.size(); ++b) {
    const Block& block = granite().blocks[b];
    const Box box = block.bounds.moved(block.centre);
    std::size_t rock = 0, inside = 0;
    for (const Vec3& anchor : block.anchors) {
      const Vec3 p = block.centre + anchor;
      const bool counts = p.z > 2.0 && p.z < 3.0;
      inside += counts;
      rock += counts && p.x - 8.0 <= 0.0;
    }
    const bool stands = node->block_present({-1, 0, 0}, b);
    EXPECT_FALSE(stands && (box.hi.z <= 2.0 || box.lo.z >= 3.0)) << b;
    EXPECT_TRUE(inside == 0 || stands == (2 * rock >= inside)) << b;
  }
}

}  // namespace
}  // namespace outcrop

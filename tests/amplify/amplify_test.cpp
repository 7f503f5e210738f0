#include "outcrop/amplify/amplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "implicit/field_contract.h"
#include "outcrop/core/parallel.h"
#include "outcrop/core/rng.h"
#include "outcrop/mesh/polygonize.h"
#include "terraces.h"

namespace outcrop {
namespace {

StrataFile small_blocks(BlockType type = BlockType::Equidimensional) {
  StrataFile strata;
  strata.materials[0].block_type = type;
  strata.materials[0].tile_side = 8.0;
  strata.materials[0].sample_spacing = 0.45;
  return strata;
}

Amplified amplified(const Heightfield& heightfield, const StrataFile& strata = small_blocks(), double resolution = 0.1) {
  return amplify(heightfield, strata, {.region_lo = heightfield.lo(), .region_hi = heightfield.hi(), .resolution = resolution});
}

TEST(Amplify, LeavesGroundBelowTheSlopeThresholdUnchangedToTheBit) {
  const Heightfield heightfield = test::terraces();
  const Amplified a = amplified(heightfield);
  Rng rng(1, "amplify test");
  int flat = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double x = rng.uniform(0.0, 63.0);
    const double y = rng.uniform(0.0, 63.0);
    const double dz = rng.uniform(-3.0, 3.0);
    const Heightfield::Sample s = heightfield.at(x, y);
    if (std::hypot(s.hx, s.hy) >= std::tan(radians(40.0))) continue;
    ++flat;
    ASSERT_EQ(a.field->value({x, y, s.h + dz}), a.terrain->value({x, y, s.h + dz}));
  }
  EXPECT_GT(flat, 5000);
}

TEST(Amplify, GivesNineTenthsOfTheSteepSurfaceToBlocksNearTheInput) {
  for (const BlockType type : {BlockType::Equidimensional, BlockType::Rhombohedral, BlockType::Tabular}) {
    const Amplified a = amplified(test::terraces(), small_blocks(type));
    EXPECT_GE(a.rock_coverage, 0.9) << name(type);
    EXPECT_LT(std::abs(a.mean_offset), 0.25 * a.mean_block_size) << name(type);
    EXPECT_GT(a.rocks.at(0).replicated_blocks, 50u) << name(type);
  }
}

TEST(Amplify, MeshVerticesOnGroundThatIsNotSteepLieOnTheInput) {
  const Heightfield heightfield = test::terraces();
  const double cell = 0.25;
  const Amplified a = amplified(heightfield, small_blocks(), cell);
  const TriangleMesh mesh = polygonize(*a.field, {.region = a.region, .resolution = cell, .parts = Parts::Grounded}).mesh;
  std::size_t flat = 0;
  for (const Vec3f& position : mesh.positions) {
    const Vec3 p = mesh.origin + Vec3(position);
    // Blocks may hang over the foot of a wall: flat ground means flat for a metre around.
    double steepest = 0.0;
    for (const Vec2& step : {Vec2(0, 0), Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)}) {
      const Heightfield::Sample s = heightfield.at(p.x + step.x, p.y + step.y);
      steepest = std::max(steepest, std::hypot(s.hx, s.hy));
    }
    if (steepest > std::tan(radians(35.0))) continue;
    ++flat;
    // The mesher keeps vertices a fiftieth of a cell away from its lattice's nodes (mesh/polygonize.h).
    ASSERT_NEAR(p.z, heightfield.at(p.x, p.y).h, cell / 50.0 + 1e-3) << p.x << ' ' << p.y;
  }
  EXPECT_GT(flat, mesh.positions.size() / 5);
}

// Blocks, strata and reliefs hang on the terrain's south-west sample, so they move with it: the whole mesh is the same.
TEST(Amplify, GivesTheSameMeshFiveThousandKilometresAway) {
  const auto meshed = [](const Vec2& origin) {
    ElevationGrid grid = test::terraces().grid();
    grid.origin = origin;
    const Amplified a = amplify(Heightfield(grid), small_blocks(),
                                {.region_lo = origin + 8.0, .region_hi = origin + 40.0, .resolution = 0.2});
    return polygonize(*a.field, {.region = a.region,
                                 .origin = Vec3(origin, 0.0),
                                 .resolution = 0.2,
                                 .tolerance = 0.02,
                                 .border = Border::Closed,
                                 .parts = Parts::Grounded})
        .mesh;
  };
  const TriangleMesh here = meshed(Vec2(0.0)), there = meshed({411'234.56, 5'234'567.89});
  EXPECT_EQ(there.triangles, here.triangles);
  EXPECT_EQ(there.labels, here.labels);
  ASSERT_EQ(there.positions.size(), here.positions.size());
  ASSERT_GT(here.positions.size(), 20'000u);
  for (std::size_t v = 0; v < here.positions.size(); ++v)
    ASSERT_LT(glm::length(there.positions[v] - here.positions[v]), 1e-3f) << v;
}

TEST(Amplify, PassesTheFieldContract) {
  const Amplified a = amplified(test::terraces());
  test::check_field_contract(*a.field, {Vec3(2.0, 2.0, -2.0), Vec3(61.0, 61.0, 28.0)});
}

TEST(Amplify, LeavesOutBlocksThatTheResolutionCannotShow) {
  const Amplified coarse = amplified(test::terraces(), small_blocks(), 3.0);
  EXPECT_EQ(coarse.rocks.at(0).replicated_blocks, 0u);
  EXPECT_EQ(coarse.field->value({30.0, 30.0, 12.0}), coarse.terrain->value({30.0, 30.0, 12.0}));
}

TEST(Amplify, FarFromTheOriginIsTheSameRock) {
  const Vec2 far(5e6, 5e6);
  const Amplified here = amplified(test::terraces()), there = amplified(test::terraces(far));
  Rng rng(2, "amplify test");
  for (int i = 0; i < 5'000; ++i) {
    const double x = rng.uniform(1.0, 62.0);
    const double y = rng.uniform(1.0, 62.0);
    const double z = rng.uniform(-1.0, 27.0);
    ASSERT_NEAR(here.field->value({x, y, z}), there.field->value({x + far.x, y + far.y, z}), 1e-4);
  }
}

TEST(Amplify, IsTheSameForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    return amplified(test::terraces());
  };
  const Amplified one = run(1), two = run(2);
  Rng rng(3, "amplify test");
  for (int i = 0; i < 5'000; ++i) {
    const double x = rng.uniform(1.0, 62.0);
    const double y = rng.uniform(1.0, 62.0);
    const double z = rng.uniform(-1.0, 27.0);
    ASSERT_EQ(one.field->value({x, y, z}), two.field->value({x, y, z}));
  }
}

/// Blocks of some 1.6 m, cut again into some of 0.4 m.
StrataFile blocks_of_blocks() {
  StrataFile file = small_blocks();
  RockMaterial finer;
  finer.tile_side = 2.0;
  finer.aperture = 0.03;
  finer.variants = 2;
  file.materials[0].finer = std::make_shared<const RockMaterial>(std::move(finer));
  return file;
}

TEST(Amplify, FinerJointsTooSmallForTheResolutionChangeNothingAndCostNothing) {
  const Amplified with = amplified(test::terraces(), blocks_of_blocks(), 0.25);
  const Amplified without = amplified(test::terraces(), small_blocks(), 0.25);
  EXPECT_EQ(with.rocks.at(0).finer_blocks, 0u);
  EXPECT_EQ(with.rocks.at(0).bytes, without.rocks.at(0).bytes);
  const auto meshed = [](const Amplified& a) {
    return polygonize(*a.field, {.region = a.region, .resolution = 0.5, .parts = Parts::Grounded}).mesh;
  };
  const TriangleMesh a = meshed(with), b = meshed(without);
  ASSERT_GT(a.positions.size(), 10'000u);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.labels, b.labels);
}

TEST(Amplify, FinerJointsOnlyTakeRockAwayAtTheSurfaceOfBlocks) {
  const Amplified with = amplified(test::terraces(), blocks_of_blocks(), 0.02);
  const Amplified without = amplified(test::terraces(), small_blocks(), 0.02);
  EXPECT_GT(with.rocks.at(0).finer_blocks, 20 * with.rocks.at(0).replicated_blocks);
  Rng rng(8, "amplify test");
  const Heightfield heightfield = test::terraces();
  int taken = 0;
  for (int i = 0; i < 40'000; ++i) {
    const double x = rng.uniform(1.0, 62.0);
    const double y = rng.uniform(1.0, 62.0);
    const double z = heightfield.at(x, y).h + rng.uniform(-2.0, 1.0);
    const double before = without.field->value({x, y, z}), after = with.field->value({x, y, z});
    ASSERT_GE(after, before);
    ASSERT_TRUE(after < 0.0 || before > -0.3) << before;
    taken += after >= 0.0 && before < 0.0;
  }
  EXPECT_GT(taken, 100);
}

TEST(Amplify, BlocksOfBlocksPassTheFieldContract) {
  const Amplified a = amplified(test::terraces(), blocks_of_blocks(), 0.02);
  test::check_field_contract(*a.field, {Vec3(10.0, 20.0, -2.0), Vec3(40.0, 40.0, 28.0)}, 3);
}

StrataFile bedded(double undulation = 0.5) {
  StrataFile file = small_blocks();
  file.materials.push_back(file.materials[0]);
  file.materials[1].name = "other";
  file.materials[1].block_type = BlockType::Prismatic;
  file.strata.layers = {{.material = 0, .top = 2.3}, {.material = 1, .top = 4.4}};
  file.strata.base = file.base = 0.0;
  file.strata.dip = radians(10.0);
  file.strata.undulation = undulation;
  file.strata.undulation_wavelength = 20.0;
  return file;
}

/// Every point of rock has the label of the rock that the strata hold there, so no block reaches into another's bed.
void expect_labels_of_the_strata(const StrataFile& file, const Heightfield& heightfield) {
  const Amplified a = amplified(heightfield, file, 0.05);
  const Strata strata = strata_on(file, heightfield);
  const Label ground = static_cast<Label>(file.materials.size());
  Rng rng(4, "amplify test");
  std::array<int, 2> seen{};
  for (int i = 0; i < 40'000; ++i) {
    const double x = rng.uniform(1.0, 62.0);
    const double y = rng.uniform(1.0, 62.0);
    const double z = heightfield.at(x, y).h + rng.uniform(-3.0, 1.0);
    const double px[] = {x}, py[] = {y}, pz[] = {z};
    if (a.field->value({x, y, z}) >= -1e-3) continue;  // A closed joint welds by a millimetre.
    Label label = 0;
    a.field->labels({px, py, pz}, {&label, 1});
    if (label == ground) continue;
    ASSERT_EQ(label, strata.material({x, y, z})) << x << ' ' << y << ' ' << z;
    ++seen[label];
  }
  EXPECT_GT(seen[0], 2000);
  EXPECT_GT(seen[1], 2000);
}

TEST(Amplify, NoBlockHasTwoColours) { expect_labels_of_the_strata(bedded(), test::terraces()); }

TEST(Amplify, NoBlockCrossesAFoldOrAFault) {
  StrataFile file = bedded(0.0);
  file.strata.fold = {.amplitude = 2.0, .wavelength = 30.0, .axis = 0.4};
  file.strata.faults = {{.point = {30.0, 30.0, 12.0}, .dip = radians(60.0), .dip_direction = 1.0, .slip = 1.3}};
  expect_labels_of_the_strata(file, test::terraces());
}

TEST(Amplify, BeddedRockCoversTheSteepSurfaceToo) {
  const Amplified a = amplified(test::terraces(), bedded());
  EXPECT_GE(a.rock_coverage, 0.9);
  EXPECT_LT(std::abs(a.mean_offset), 0.25 * a.mean_block_size);
}

TEST(Amplify, BeddedRockPassesTheFieldContract) {
  StrataFile file = bedded();
  file.strata.faults = {{.point = {30.0, 30.0, 12.0}, .dip = radians(60.0), .dip_direction = 1.0, .slip = 1.3}};
  const Amplified a = amplified(test::terraces(), file);
  test::check_field_contract(*a.field, {Vec3(2.0, 2.0, -2.0), Vec3(61.0, 61.0, 28.0)}, 3);
}

TEST(Amplify, BlocksOfBlocksInBedsPassTheFieldContract) {
  StrataFile file = bedded();
  file.materials[1].finer = blocks_of_blocks().materials[0].finer;
  const Amplified a = amplified(test::terraces(), file, 0.02);
  EXPECT_EQ(a.rocks.at(0).finer_blocks, 0u);
  EXPECT_GT(a.rocks.at(1).finer_blocks, 10'000u);
  test::check_field_contract(*a.field, {Vec3(10.0, 20.0, -2.0), Vec3(40.0, 40.0, 28.0)}, 3);
}

/// Rock in the northern half, thinning out southwards.
StrataFile ruled() {
  StrataFile file = small_blocks();
  file.placement.where = PlacementRule{
      .kind = PlacementRule::Kind::Box, .soft = 12.0, .box = {Vec3(-1e3, 25.0, -1e3), Vec3(1e3, 1e3, 1e3)}};
  return file;
}

TEST(Amplify, LeavesGroundThatARuleExcludesUnchangedToTheBit) {
  const Heightfield heightfield = test::terraces();
  const Amplified a = amplified(heightfield, ruled()), all = amplified(heightfield);
  EXPECT_LT(a.rocks.at(0).replicated_blocks, all.rocks.at(0).replicated_blocks);
  Rng rng(5, "amplify test");
  int changed = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double x = rng.uniform(0.0, 63.0);
    const double y = rng.uniform(0.0, 63.0);
    const double z = heightfield.at(x, y).h + rng.uniform(-3.0, 3.0);
    const bool same = a.field->value({x, y, z}) == a.terrain->value({x, y, z});
    ASSERT_TRUE(same || y > 25.0) << x << ' ' << y << ' ' << z;
    changed += !same;
  }
  EXPECT_GT(changed, 2000);
}

TEST(Amplify, ARuleThatHoldsEverywhereChangesNothing) {
  StrataFile file = small_blocks();
  file.placement.where = PlacementRule{.kind = PlacementRule::Kind::Altitude, .lo = -1e3, .hi = 1e3};
  const Amplified a = amplified(test::terraces(), file), b = amplified(test::terraces());
  EXPECT_EQ(a.rocks.at(0).replicated_blocks, b.rocks.at(0).replicated_blocks);
  Rng rng(6, "amplify test");
  for (int i = 0; i < 5000; ++i) {
    const double x = rng.uniform(0.0, 63.0);
    const double y = rng.uniform(0.0, 63.0);
    const double z = rng.uniform(-1.0, 27.0);
    ASSERT_EQ(a.field->value({x, y, z}), b.field->value({x, y, z}));
  }
}

TEST(Amplify, RulesGiveTheSameForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    return amplified(test::terraces(), ruled());
  };
  const Amplified one = run(1), two = run(2);
  EXPECT_EQ(one.rocks.at(0).replicated_blocks, two.rocks.at(0).replicated_blocks);
  Rng rng(7, "amplify test");
  for (int i = 0; i < 3000; ++i) {
    const double x = rng.uniform(1.0, 62.0);
    const double y = rng.uniform(20.0, 62.0);
    const double z = rng.uniform(-1.0, 27.0);
    ASSERT_EQ(one.field->value({x, y, z}), two.field->value({x, y, z}));
  }
}

TEST(SteepestWindow, FindsTheWallAndItsWayDown) {
  const SteepWindow window = steepest_window(test::terraces(), 20.0, radians(40.0));
  const Heightfield heightfield = test::terraces();
  const Heightfield::Sample s = heightfield.at(window.focus.x, window.focus.y);
  EXPECT_GE(std::hypot(s.hx, s.hy), std::tan(radians(40.0)));
  EXPECT_LT(window.downhill.x, -0.8);  // The walls fall to the west.
  EXPECT_GT(window.share, 0.1);
}

}  // namespace
}  // namespace outcrop

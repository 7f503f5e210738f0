#include <gtest/gtest.h>

#include <cmath>

#include "core/scratch.h"
#include "outcrop/amplify/run_amplify.h"
#include "outcrop/core/error.h"
#include "terraces.h"

namespace outcrop {
namespace {

Heightfield slope(int samples, double cell, double tangent, bool georeferenced = false, Vec2 origin = Vec2(0.0)) {
  ElevationGrid grid{.width = samples, .height = samples, .cell_x = cell, .cell_y = cell, .origin = origin,
                     .georeferenced = georeferenced};
  for (int row = 0; row < samples; ++row)
    for (int column = 0; column < samples; ++column) grid.elevations.push_back(static_cast<float>(tangent * cell * column));
  return Heightfield(std::move(grid));
}

AmplifyRun with_region(std::array<double, 4> region) {
  AmplifyRun run;
  run.region = region;
  return run;
}

bool whole(double cells) { return std::abs(cells - std::round(cells)) < 1e-6; }

TEST(Window, KeepsARegionAndAResolutionThatAreGiven) {
  const Heightfield terrain = slope(101, 10.0, 0.5);
  AmplifyRun run = with_region({100, 200, 400, 300});
  run.resolution = 2.5;
  const Window window = choose_window(terrain, {}, run);
  EXPECT_EQ(window.lo, Vec2(100, 200));
  EXPECT_EQ(window.hi, Vec2(400, 300));
  EXPECT_EQ(window.resolution, 2.5);
  EXPECT_EQ(window.note, "");
}

TEST(Window, ReadsRegionsInMapCoordinatesWhereThereAreSuch) {
  const Window window = choose_window(slope(101, 10.0, 0.5, true, {4.1e5, 5.2e6}), {}, with_region({410100, 5200200, 410140, 5200230}));
  EXPECT_NEAR(window.lo.x, 410100, 1e-9);
  EXPECT_NEAR(window.hi.y, 5200230, window.resolution);
}

TEST(Window, IsAWholeNumberOfCellsInsideTheTerrain) {
  const Heightfield terrain = slope(101, 10.0, 0.5);
  for (const double resolution : {0.3, 0.7, 1.1, 3.3, 7.0}) {
    AmplifyRun run;
    run.resolution = resolution;
    const Window window = choose_window(terrain, {}, run);
    EXPECT_TRUE(whole((window.hi.x - window.lo.x) / resolution));
    EXPECT_TRUE(whole((window.hi.y - window.lo.y) / resolution));
    EXPECT_LE(window.hi.x, 1000.0 + 1e-9);
    EXPECT_GT(window.hi.x, 1000.0 - resolution);
  }
}

TEST(Window, RefusesARegionOutsideAndNamesTheTerrain) {
  const Heightfield terrain = slope(101, 10.0, 0.5);
  for (const std::array<double, 4>& region : {std::array{1100.0, 0.0, 1200.0, 100.0}, std::array{-5.0, 0.0, 50.0, 50.0},
                                              std::array{50.0, 50.0, 50.0, 60.0}, std::array{60.0, 50.0, 50.0, 60.0},
                                              std::array{0.0, std::nan(""), 50.0, 60.0}}) {
    const std::string error = test::message_of<ParameterError>([&] { (void)choose_window(terrain, {}, with_region(region)); });
    EXPECT_NE(error.find("--region"), std::string::npos) << error;
    EXPECT_NE(error.find("0 0 1000 1000"), std::string::npos) << error;
  }
}

TEST(Window, TakesTheWholeTerrainWhenItIsSmallElseItsSteepestPart) {
  const Window small = choose_window(slope(101, 1.0, 1.5), {}, {});
  EXPECT_EQ(small.note, "");
  EXPECT_EQ(small.lo, Vec2(0.0));
  EXPECT_GT(small.hi.x, 99.0);
  const Window part = choose_window(slope(201, 30.0, 1.5), {}, {});
  EXPECT_NE(part.note.find("steepest"), std::string::npos);
  EXPECT_LT(part.hi.x - part.lo.x, 1000.0);
  EXPECT_GT(part.hi.x - part.lo.x, 50.0);
  EXPECT_NEAR(part.resolution, 20.0 / 60.0, 1e-12) << "a twelfth of a block, a fifth of a tile";
}

TEST(Window, CoarsensALargeRegionToABudget) {
  const Window window = choose_window(slope(201, 30.0, 1.5), {}, with_region({0, 0, 6000, 6000}));
  const double cells = 6000.0 * 6000.0 * std::sqrt(1.0 + 1.5 * 1.5) / (window.resolution * window.resolution);
  EXPECT_LT(cells, 2e6) << "six triangles a cell of rock";
  EXPECT_GT(cells, 0.5e6);
  EXPECT_NE(window.note.find("--resolution"), std::string::npos);
}

TEST(Window, RefusesResolutionsThatMakeNoMesh) {
  for (const double resolution : {0.0, -1.0, 500.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    AmplifyRun run;
    run.resolution = resolution;
    EXPECT_THROW((void)choose_window(slope(101, 10.0, 0.5), {}, run), ParameterError) << resolution;
  }
}

}  // namespace
}  // namespace outcrop

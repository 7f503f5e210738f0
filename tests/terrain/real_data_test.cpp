// Elevation models of real ground, against what is known about them. Skipped where the files are not there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "outcrop/terrain/heightfield.h"
#include "outcrop/terrain/read_heightfield.h"
#include "terrain_samples.h"

namespace outcrop {
namespace {

namespace fs = std::filesystem;

/// What the data's list of sources says about a file.
struct Expected {
  const char* file;
  int width, height;
  double cell_x, cell_y;
  double lowest, highest;  ///< Metres, to 0.1 m.
  double valid;            ///< Share of samples.
  double steepest_deg;     ///< Central differences at cell size, cells beside nodata left out; 0: not told.
};

class RealData : public ::testing::TestWithParam<Expected> {
 protected:
  [[nodiscard]] static fs::path path() { return fs::path(OUTCROP_SHARED_DATA) / "dem" / GetParam().file; }
};

double steepest_deg(const ElevationGrid& grid) {
  double steepest = 0.0;
  for (int r = 1; r + 1 < grid.height; ++r) {
    for (int c = 1; c + 1 < grid.width; ++c) {
      const double dx = (grid.at(c + 1, r) - grid.at(c - 1, r)) / (2.0 * grid.cell_x);
      const double dy = (grid.at(c, r + 1) - grid.at(c, r - 1)) / (2.0 * grid.cell_y);
      const double slope = std::sqrt(dx * dx + dy * dy);
      if (slope > steepest) steepest = slope;  // NaN beside nodata never is.
    }
  }
  return degrees(std::atan(steepest));
}

TEST_P(RealData, ReadsAsItsSourceSays) {
  if (!fs::exists(path())) GTEST_SKIP() << path() << " is not there";
  const Expected& expected = GetParam();
  const HeightfieldFile file = read_heightfield(path());
  const ElevationGrid& grid = file.grid;
  EXPECT_EQ(grid.width, expected.width);
  EXPECT_EQ(grid.height, expected.height);
  EXPECT_NEAR(grid.cell_x, expected.cell_x, 0.005 * expected.cell_x);
  EXPECT_NEAR(grid.cell_y, expected.cell_y, 0.005 * expected.cell_y);
  Interval range;
  std::size_t valid = 0;
  for (const float h : grid.elevations) {
    if (std::isnan(h)) continue;
    range.include(h);
    ++valid;
  }
  EXPECT_NEAR(range.lo, expected.lowest, 0.06);
  EXPECT_NEAR(range.hi, expected.highest, 0.06);
  EXPECT_NEAR(static_cast<double>(valid) / static_cast<double>(grid.elevations.size()), expected.valid, 0.001);
  if (expected.steepest_deg > 0.0) {
    EXPECT_NEAR(steepest_deg(grid), expected.steepest_deg, 2.0);
  }
}

TEST_P(RealData, TheSurfacePassesThroughEverySample) {
  if (!fs::exists(path())) GTEST_SKIP() << path() << " is not there";
  const ElevationGrid grid = read_heightfield(path()).grid;
  const Heightfield heightfield(grid);
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      if (std::isnan(grid.at(c, r))) continue;
      const Vec2 p = test::sample_position(grid, c, r);
      ASSERT_NEAR(heightfield.at(p.x, p.y).h, grid.at(c, r), 1e-4) << "column " << c << ", row " << r;
    }
  }
  // Neither interpolation nor filling leaves the range of the data by more than a step at a cliff.
  const Interval all = heightfield.height_bound(heightfield.lo(), heightfield.hi());
  const double range = GetParam().highest - GetParam().lowest;
  EXPECT_GT(all.lo, GetParam().lowest - 0.1 * range);
  EXPECT_LT(all.hi, GetParam().highest + 0.1 * range);
}

INSTANTIATE_TEST_SUITE_P(
    Dem, RealData,
    ::testing::Values(Expected{"seacliff_ca_aoi1/aoi1_dem.tif", 736, 170, 1, 1, 0.3, 50.5, 0.668, 82.7},
                      Expected{"seacliff_ca_aoi1/seacliff_ca_aoi1_f32.tif", 736, 170, 1, 1, 0.3, 50.5, 0.668, 82.7},
                      Expected{"seacliff_ca_aoi4/aoi4_dem.tif", 427, 721, 1, 1, -0.2, 105.9, 0.594, 83.9},
                      Expected{"seacliff_ca_aoi7/aoi7_dem.tif", 937, 859, 1, 1, -0.8, 86.3, 0.461, 87.9},
                      Expected{"alps_alr_5m/alps_alr_5m_f32.tif", 417, 915, 5, 5, 566.1, 2452.3, 0.694, 82.3},
                      Expected{"alps_gar_5m/alps_gar_5m_f32.tif", 520, 387, 4.998, 4.998, 1234.0, 2672.2, 0.588, 85.7},
                      Expected{"fluchthorn_10m/fluchthorn_10m_f32.tif", 300, 220, 10, 10, 2330.7, 3395.0, 1.0, 78.3},
                      Expected{"edinburgh_crags_2p5m/holyroodpark.tif", 815, 563, 2.5, 2.5, 33.8, 250.8, 1.0, 83.2},
                      Expected{"zion_srtm90/srtm.tif", 465, 457, 73.771, 92.611, 1024.0, 2892.0, 1.0, 71.5},
                      Expected{"sthelens_30m/sthelens_30m_f32.tif", 327, 468, 30, 30, 682.0, 2543.0, 0.973, 69.2},
                      Expected{"chantsura_scree_5cm/chantsura_scree_5cm_f32.tif", 94, 154, 0.05, 0.05, 2372.1, 2380.9,
                               1.0, 87.6}),
    [](const auto& test) {
      std::string name = fs::path(test.param.file).stem().string();
      std::replace_if(
          name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
      return name;
    });

TEST(RealDataFolder, EveryTiffReads) {
  const fs::path folder = fs::path(OUTCROP_SHARED_DATA) / "dem";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".tif") continue;
    ++count;
    EXPECT_NO_THROW({
      const HeightfieldFile file = read_heightfield(entry.path());
      EXPECT_TRUE(file.grid.georeferenced) << entry.path();
    }) << entry.path();
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace outcrop

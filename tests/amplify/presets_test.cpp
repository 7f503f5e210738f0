#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include "outcrop/amplify/amplify.h"
#include "outcrop/amplify/strata_file.h"
#include "outcrop/core/data_path.h"

namespace outcrop {
namespace {

/// The rocks of data/strata but for the canyon's, whose layers belong to its own terrain.
std::vector<std::filesystem::path> presets() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(data_path() / "strata"))
    if (entry.path().stem() != "canyon") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// A plateau, a wall of 26 samples and 72 degrees that faces south, and a floor: 32 x 32 samples.
Heightfield wall(double cell) {
  ElevationGrid grid{.width = 32, .height = 32, .cell_x = cell, .cell_y = cell};
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column) {
      const double behind = std::clamp((31 - row) - 12.0 - std::sin(0.4 * column), 0.0, 8.5);
      grid.elevations.push_back(static_cast<float>(cell * 26.0 / 8.5 * behind));
    }
  return Heightfield(std::move(grid));
}

class Presets : public testing::Test {
 protected:
  struct Made {
    std::string name;
    StrataFile file;
    Amplified amplified;
  };

  /// All of them on walls as large as their rock asks for.
  static void SetUpTestSuite() {
    made_ = std::make_unique<std::vector<Made>>();
    for (const std::filesystem::path& path : presets()) {
      Made made{.name = path.stem().string(), .file = read_strata(path), .amplified = {}};
      double side = 0.0;
      for (const RockMaterial& material : made.file.materials) side = std::max(side, material.tile_side);
      const double cell = side / 16.0;
      const Heightfield heightfield = wall(cell);
      made.amplified = amplify(heightfield, made.file, {.region_lo = heightfield.lo(), .region_hi = heightfield.hi(),
                                                        .resolution = 0.1 * cell, .measure = true});
      made_->push_back(std::move(made));
    }
  }
  static void TearDownTestSuite() { made_.reset(); }

  static inline std::unique_ptr<std::vector<Made>> made_;
};

TEST_F(Presets, AreAtLeastTen) { EXPECT_GE(made_->size(), 10u); }

TEST_F(Presets, CoverAWallOfTheirSizeWithBlocks) {
  for (const Made& made : *made_) {
    // Layers thinner than a block lose blocks at their boundaries.
    EXPECT_GE(made.amplified.rock_coverage, made.file.strata.layers.size() > 4 ? 0.75 : 0.9) << made.name;
    for (const RockReport& rock : made.amplified.rocks)
      EXPECT_GT(rock.replicated_blocks, 20u) << made.name << ", " << rock.material;
  }
}

TEST_F(Presets, HaveJointsAsFarApartAsTheySay) {
  for (const Made& made : *made_)
    for (std::size_t m = 0; m < made.amplified.rocks.size(); ++m) {
      const TileReport& measured = made.amplified.rocks[m].measured.value();
      double asked_jv = 0.0, made_jv = 0.0;
      for (std::size_t s = 0; s < made.file.materials[m].joints->sets.size(); ++s) {
        const JointSet& set = made.file.materials[m].joints->sets[s];
        if (set.spacing <= 0.0) continue;
        const double spacing = measured.statistics.sets.at(s).spacing;
        asked_jv += 1.0 / set.spacing;
        made_jv += 1.0 / spacing;
        if (set.spacing > made.file.materials[m].tile_side / 5.0) continue;  // few joints a tile: their mean scatters
        EXPECT_LT(std::abs(std::log(spacing / set.spacing)), std::log(1.5)) << made.name << ", " << set.name;
      }
      EXPECT_NEAR(made_jv / asked_jv, 1.0, 0.25) << made.name << ", " << made.amplified.rocks[m].material;
    }
}

}  // namespace
}  // namespace outcrop

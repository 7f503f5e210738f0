#include "outcrop/fracture/rock_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fracture/hand_tiles.h"
#include "outcrop/core/error.h"
#include "outcrop/core/json.h"
#include "outcrop/core/parallel.h"
#include "outcrop/fracture/rock_formulas.h"

namespace outcrop {
namespace {

const Tile& made_tile(BlockType type, Seed seed) {
  static std::map<std::pair<BlockType, Seed>, Tile> tiles;
  const auto [it, is_new] = tiles.try_emplace({type, seed});
  if (is_new) it->second = make_tile({.type = type}, seed);
  return it->second;
}

const SetStatistics* group(const RockStatistics& rock, int set) {
  const auto it = std::find_if(rock.sets.begin(), rock.sets.end(), [&](const auto& s) { return s.set == set; });
  return it == rock.sets.end() ? nullptr : &*it;
}

TEST(RockStatistics, MeasureAGridOfBlocksExactly) {
  const double side = 12.0;
  const Tile tile = test::grid_tile(
      side, {test::even_places(side, 4), test::even_places(side, 3), test::even_places(side, 12)}, 0.05);
  const RockStatistics rock = measure_rock(tile);
  const double expected[] = {3.0, 4.0, 1.0};
  ASSERT_EQ(rock.sets.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(rock.sets[k].spacing, expected[k], 1e-9);
    EXPECT_NEAR(rock.sets[k].spacing_cv, 0.0, 1e-6);
    EXPECT_NEAR(rock.sets[k].p32, 1.0 / expected[k], 1e-9);
    EXPECT_EQ(rock.sets[k].joints, std::size_t(side / expected[k] + 0.5));
    EXPECT_NEAR(rock.sets[k].trace_mean, side, 1e-9);  // persistent: as long as the cut
    EXPECT_NEAR(std::abs(rock.sets[k].orientation.mean[int(k)]), 1.0, 1e-12);
  }
  EXPECT_NEAR(rock.jv, 1.0 / 3.0 + 1.0 / 4.0 + 1.0, 1e-9);
  EXPECT_NEAR(rock.p32, rock.jv, 1e-9);
  const double volume = 2.95 * 3.95 * 0.95;
  EXPECT_NEAR(rock.volume_mean, volume, 1e-9);
  EXPECT_NEAR(rock.volume_by_volume.d90, volume, 1e-9);
  EXPECT_NEAR(rock.gap_share, 1.0 - volume / 12.0, 1e-9);
  EXPECT_NEAR(rock.faces_mean, 6.0, 1e-12);
  EXPECT_NEAR(rock.elongation, 3.95 / 2.95, 1e-9);
  EXPECT_NEAR(rock.flatness, 2.95 / 0.95, 1e-9);
  EXPECT_NEAR(rock.beta / block_shape_factor({3, 4, 1}), volume / 12.0, 1e-9);
  EXPECT_EQ(rock.rqd_measured, 100.0);
}

TEST(RockStatistics, RqdCountsThePiecesOfTenCentimetres) {
  // Every second piece of the core is 6 cm long, the others 24 cm.
  std::vector<double> places;
  for (int i = 0; i < 10; ++i) places.insert(places.end(), {0.3 * i, 0.3 * i + 0.06});
  const Tile tile = test::grid_tile(3.0, {test::even_places(3.0, 1), test::even_places(3.0, 1), places}, 0.0);
  const RockStatistics rock = measure_rock(tile);
  EXPECT_NEAR(rock.rqd_measured, 80.0, 0.5);
  EXPECT_NEAR(rock.joints_per_metre[2], 20.0 / 3.0, 1e-9);
  EXPECT_NEAR(rock.sets[2].spacing_cv, 0.6, 0.01);
}

// Joints at random places: spacings are exponential, volumes their products, by the closed forms (in units of the
// mean): CV √7 = 2.646, median 0.223; by volume D10 0.572, D50 3.94, D90 19.4.
TEST(RockStatistics, RandomPersistentJointsHaveTheVolumesOfTheClosedForms) {
  const int seeds = 50;
  const int count = 10;
  const double side = 10.0;
  double cv = 0.0, spacing_cv = 0.0;
  double median = 0.0;
  Quantiles by_volume;
  for (Seed seed = 1; seed <= seeds; ++seed) {
    const Tile tile =
        test::grid_tile(side,
                        {test::random_places(side, count, seed, "x"), test::random_places(side, count, seed, "y"),
                         test::random_places(side, count, seed, "z")},
                        0.0);
    const RockStatistics rock = measure_rock(tile);
    EXPECT_NEAR(rock.volume_mean, 1.0, 1e-9);
    EXPECT_NEAR(rock.sets[0].spacing, 1.0, 1e-9);
    EXPECT_NEAR(rock.sets[0].scanned_spacing, 1.0, 0.03);
    spacing_cv += rock.sets[0].spacing_cv / seeds;
    cv += rock.volume_cv / seeds;
    median += rock.volume_by_number.d50 / seeds;
    by_volume.d10 += rock.volume_by_volume.d10 / seeds;
    by_volume.d50 += rock.volume_by_volume.d50 / seeds;
    by_volume.d90 += rock.volume_by_volume.d90 / seeds;
  }
  // n places on a circle: the spacing's CV is √((n − 1)/(n + 1)), so that the volume's is √((1 + CV²)³ − 1) = 2.29.
  const double circle = std::sqrt((count - 1.0) / (count + 1.0));
  EXPECT_NEAR(spacing_cv, circle, 0.05);
  EXPECT_NEAR(cv, std::sqrt(std::pow(1.0 + circle * circle, 3.0) - 1.0), 0.2);
  EXPECT_NEAR(median, 0.223, 0.04);  // ten places on a circle are a little more even
  EXPECT_NEAR(by_volume.d10 / 0.572, 1.0, 0.15);
  EXPECT_NEAR(by_volume.d50 / 3.94, 1.0, 0.15);
  EXPECT_NEAR(by_volume.d90 / 19.4, 1.0, 0.35);  // ten joints a side hold few of the largest
}

// Two ways to one number: a line along t meets P10 = Σ area |n · t| / volume joints, whatever their shapes.
TEST(RockStatistics, ScanLinesMeetWhatTheAreasSay) {
  for (const BlockType type : kBlockTypes) {
    SCOPED_TRACE(name(type));
    const RockStatistics rock = measure_rock(made_tile(type, 2));
    double p32 = 0.0;
    for (const SetStatistics& set : rock.sets) {
      p32 += set.p32;
      if (set.spacings < 500) continue;
      EXPECT_NEAR(set.scanned_spacing / set.spacing, 1.0, 0.07);  // lines around a torus meet the same joints again
      EXPECT_GE(set.spacing * set.p32, 1.0 - 1e-9);               // |n · t| ≤ 1
      EXPECT_LE(set.spacing * set.p32, 1.0 + 1e-9 + 2.0 / set.orientation.kappa);
    }
    EXPECT_NEAR(rock.p32, p32, 1e-9);
    EXPECT_NEAR(rock.jv / rock.p32, 1.0, 0.05);
    // The sum of |cosines| over three axes lies between 1 and √3.
    const double rates = rock.joints_per_metre[0] + rock.joints_per_metre[1] + rock.joints_per_metre[2];
    EXPECT_GT(rates, rock.p32 * 0.999);
    EXPECT_LT(rates, rock.p32 * std::sqrt(3.0) * 1.001);
  }
}

TEST(RockStatistics, FindTheOrientationsThatWereAskedFor) {
  for (const BlockType type : {BlockType::Equidimensional, BlockType::Rhombohedral, BlockType::Tabular}) {
    SCOPED_TRACE(name(type));
    const Tile& tile = made_tile(type, 3);
    const RockStatistics rock = measure_rock(tile);
    for (std::size_t s = 0; s < tile.sets.size(); ++s)
      EXPECT_GT(std::abs(glm::dot(rock.sets[s].orientation.mean, tile.sets[s].normal)), std::cos(radians(10)));
  }
}

TEST(RockStatistics, ColumnsHaveTheWallsOfNearlyRegularHexagons) {
  // P32 is 2 / width for regular hexagons, the least; 2 √q for Poisson-Voronoi cells of density q = 1 / (√3/2 width²).
  for (Seed seed = 1; seed <= 3; ++seed) {
    const RockStatistics rock = measure_rock(made_tile(BlockType::Columnar, seed));
    const SetStatistics* const columns = group(rock, kColumnJoint);
    ASSERT_NE(columns, nullptr);
    EXPECT_GT(columns->p32 * 2.4, 2.0);
    EXPECT_LT(columns->p32 * 2.4, 2.149);
  }
}

TEST(RockStatistics, AreTheSameOnOneThreadAndFour) {
  std::string texts[2];
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    JsonWriter json;
    json.begin_object();
    write_rock_statistics(json, measure_rock(made_tile(BlockType::Prismatic, 1)));
    texts[threads / 4] = json.end_object().text();
  }
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_NE(texts[0].find("\"jv_class\": \"very large\""), std::string::npos) << texts[0];
}

TEST(RockStatistics, ATileWithoutBlocksIsRefused) { EXPECT_THROW((void)measure_rock({}), ParameterError); }

}  // namespace
}  // namespace outcrop

#include "outcrop/terrain/terrain_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "implicit/field_contract.h"
#include "terrain_samples.h"

namespace outcrop {
namespace {

using test::grid_of;
using test::holed_grid;
using test::rough_grid;

Box region_of(const Heightfield& heightfield) {
  return Box{{heightfield.lo().x, heightfield.lo().y, -10.0}, {heightfield.hi().x, heightfield.hi().y, 60.0}}.grown(
      5.0);
}

TEST(TerrainField, KeepsTheFieldContract) {
  for (const Interpolation interpolation : {Interpolation::Smooth, Interpolation::Bilinear}) {
    for (const Vec2 origin : {Vec2(-3.0, 7.0), Vec2(4.1e5, 5.2e6)}) {
      const Heightfield heightfield(rough_grid(1, {2.0, 3.0}, origin), interpolation);
      test::check_field_contract(*std::make_shared<TerrainField>(heightfield), region_of(heightfield));
    }
  }
}

TEST(TerrainField, KeepsTheFieldContractAtHoles) {
  for (const NodataPolicy nodata : {NodataPolicy::Hole, NodataPolicy::Fill}) {
    for (const Interpolation interpolation : {Interpolation::Smooth, Interpolation::Bilinear}) {
      const Heightfield heightfield(holed_grid(2, {2.0, 3.0}, {10.0, 20.0}), interpolation);
      test::check_field_contract(*std::make_shared<TerrainField>(heightfield, nodata), region_of(heightfield));
    }
  }
}

TEST(TerrainField, LatticesEqualTheirSinglePoints) {
  // Batches whose positions return layer by layer, column by column, or only almost.
  const Heightfield heightfield(holed_grid(5, {2.0, 3.0}, {0.0, 0.0}));
  const auto field = std::make_shared<TerrainField>(heightfield);
  for (const int layer : {1, 9, 81, 255, 256, 300}) {
    test::PointList points;
    Rng rng(1, "lattice", static_cast<std::uint64_t>(layer));
    for (int i = 0; i < 900; ++i) {
      const int k = i % layer;
      const double stray = rng.uniform() < 0.05 ? 0.3 : 0.0;
      points.push_back({1.1 * (k % 20) + stray, 1.7 * (k / 20), 3.0 * (i / layer) - 5.0});
    }
    const test::FieldAnswers batch(*field, points.view());
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(batch.values[i], field->value(points[i])) << "layer of " << layer << ", point " << i;
      ASSERT_EQ(batch.gradients[i], field->gradient(points[i])) << "layer of " << layer << ", point " << i;
    }
  }
}

TEST(TerrainField, IsAirInHolesUnlessTheyAreFilled) {
  const Heightfield heightfield(holed_grid(3, {2.0, 2.0}, {0.0, 0.0}));
  const auto holed = std::make_shared<TerrainField>(heightfield, NodataPolicy::Hole);
  const auto filled = std::make_shared<TerrainField>(heightfield, NodataPolicy::Fill);
  const Vec3 under_the_hole(16.0, 12.0, -1e4);
  const Vec3 under_the_data(28.0, 12.0, -1e4);
  EXPECT_GT(holed->value(under_the_hole), 0.0);
  EXPECT_LT(filled->value(under_the_hole), 0.0);
  EXPECT_LT(holed->value(under_the_data), 0.0);
}

TEST(TerrainField, HoleRimsHaveNoSpikes) {
  // Elevations beside a hole stay in the range of the data: no dive towards a nodata value.
  const Heightfield heightfield(holed_grid(4, {2.0, 2.0}, {0.0, 0.0}));
  const Interval all = heightfield.height_bound(heightfield.lo(), heightfield.hi());
  EXPECT_GT(all.lo, -10.0);
  EXPECT_LT(all.hi, 60.0);
}

TEST(TerrainField, NarrowsToTheLocalSlope) {
  // A wall between two plains: flat ground takes full steps, the wall knows how steep it is.
  const Heightfield heightfield(
      grid_of(40, 10, {1.0, 1.0}, {0.0, 0.0}, [](double x, double) { return x < 20.0 ? 0.0 : 50.0; }));
  const auto field = std::make_shared<TerrainField>(heightfield);
  EXPECT_GT(field->lipschitz(), 50.0);
  EXPECT_NEAR(field->narrow({{2.0, 2.0, -1.0}, {10.0, 8.0, 1.0}})->lipschitz(), 1.0, 1e-6);
  EXPECT_GT(field->narrow({{19.2, 2.0, -1.0}, {19.8, 8.0, 1.0}})->lipschitz(), 50.0);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/tiles/bedded_rock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "implicit/field_contract.h"
#include "outcrop/core/error.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/tiles/replication.h"

namespace outcrop {
namespace {

const Box kDomain{Vec3(-20.0), Vec3(20.0)};

FieldPtr blocks(Seed seed) {
  Tile tile = make_tile({.side = 8.0, .spacing = 0.5, .aperture = 0.04, .rounding = 0.1}, seed);
  return std::make_shared<Replication>(Rock{.tile = std::move(tile), .label = static_cast<Label>(seed)}, half_space({}),
                                       ReplicationOptions{.domain = kDomain});
}

/// Two rocks on either side of a bed's boundary that dips by 15°.
struct TwoRocks {
  Plane boundary{.normal = Vec3(std::sin(radians(15.0)), 0.0, std::cos(radians(15.0))), .offset = -0.4};
  FieldPtr lower, upper;

  explicit TwoRocks(const FieldPtr& crack_floor = nullptr) {
    const BeddingJoint joint{.half_aperture = 0.02, .crack_floor = crack_floor};
    lower = bedded_rock(blocks(1), half_space(boundary), joint);
    upper = bedded_rock(blocks(2), half_space({-boundary.normal, -boundary.offset}), joint);
  }
  /// A point `above` metres above the boundary.
  [[nodiscard]] Vec3 point(Rng& rng, double above) const {
    const double x = rng.uniform(-9.0, 9.0);
    const double y = rng.uniform(-9.0, 9.0);
    const Vec3 p(x, y, 0.0);
    return p + (above - boundary.distance(p)) * boundary.normal;
  }
};

TEST(BeddedRock, PassesTheFieldContract) {
  const TwoRocks open, closed(half_space({.normal = {0, 0, 1}, .offset = 0.5}));
  test::check_field_contract(*open.upper, {Vec3(-8.0), Vec3(8.0)}, 4);
  test::check_field_contract(*union_of({closed.lower, closed.upper}), {Vec3(-8.0), Vec3(8.0)}, 4);
}

TEST(BeddedRock, LeavesNoPointToTwoRocksAndACrackOfTheApertureBetween) {
  const TwoRocks rocks;
  Rng rng(1, "bedded rock");
  int lower = 0, upper = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double above = rng.uniform(-0.5, 0.5);
    const Vec3 p = rocks.point(rng, above);
    const bool in_lower = rocks.lower->value(p) < 0.0, in_upper = rocks.upper->value(p) < 0.0;
    ASSERT_FALSE(in_lower && in_upper);
    ASSERT_FALSE((in_lower || in_upper) && std::abs(above) < 0.02 - 1e-9);
    lower += in_lower;
    upper += in_upper;
  }
  EXPECT_GT(lower, 7000);
  EXPECT_GT(upper, 7000);
}

TEST(BeddedRock, ClosesItsCrackBelowTheFloor) {
  const TwoRocks rocks(half_space({.normal = {0, 0, 1}, .offset = -100.0}));
  Rng rng(2, "bedded rock");
  int rock = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = rocks.point(rng, 0.0);
    rock += std::min(rocks.lower->value(p), rocks.upper->value(p)) < 0.0;
  }
  EXPECT_GT(rock, 2700) << "of 3000 points on the boundary; the rest lies in cracks of the tiles";
}

TEST(BeddedRock, NarrowsToTheBlocksAloneAwayFromTheBoundary) {
  const TwoRocks rocks;
  const Box box{Vec3(1.0, 1.0, 12.0), Vec3(1.5, 1.5, 12.5)};
  EXPECT_EQ(rocks.upper->narrow(box)->lipschitz(), blocks(2)->narrow(box)->lipschitz());
  EXPECT_GT(rocks.lower->bound(box).lo, 0.0);
}

TEST(BeddedRock, RefusesWhatItCannotUse) {
  EXPECT_THROW((void)bedded_rock(nullptr, half_space({}), {}), ParameterError);
  EXPECT_THROW((void)bedded_rock(half_space({}), half_space({}), {.closure_slope = 0.0}), ParameterError);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/core/box.h"

#include <gtest/gtest.h>

#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

Interval random_interval(Rng& rng) {
  const double a = rng.uniform(-5.0, 5.0);
  const double b = rng.uniform(-5.0, 5.0);
  return {std::min(a, b), std::max(a, b)};
}

TEST(Interval, OfMinAndMaxIsExactlyTheirRange) {
  for (Seed seed = 0; seed < 200; ++seed) {
    Rng rng(seed, "intervals");
    const Interval a = random_interval(rng);
    const Interval b = random_interval(rng);
    Interval mins, maxs;  // over the corners: both functions are monotone
    for (const double x : {a.lo, a.hi}) {
      for (const double y : {b.lo, b.hi}) {
        mins.include(std::min(x, y));
        maxs.include(std::max(x, y));
      }
    }
    EXPECT_EQ(min(a, b).lo, mins.lo);
    EXPECT_EQ(min(a, b).hi, mins.hi);
    EXPECT_EQ(max(a, b).lo, maxs.lo);
    EXPECT_EQ(max(a, b).hi, maxs.hi);
  }
}

TEST(Box, HullHoldsBothAndIntersectionOnlyWhatBothHold) {
  for (Seed seed = 0; seed < 100; ++seed) {
    Rng rng(seed, "boxes");
    const auto box = [&] {
      Box b;
      b.include(3.0 * rng.direction());
      b.include(3.0 * rng.direction());
      return b;
    };
    const Box a = box();
    const Box b = box();
    EXPECT_EQ(a.overlaps(b), !intersection(a, b).empty());
    for (int i = 0; i < 50; ++i) {
      const Vec3 p = 3.0 * rng.direction();
      EXPECT_EQ(intersection(a, b).contains(p), a.contains(p) && b.contains(p));
      EXPECT_TRUE(hull(a, b).contains(p) || !(a.contains(p) || b.contains(p)));
    }
  }
}

TEST(Box, IsEmptyUntilItIncludesAPoint) {
  Box box;
  EXPECT_TRUE(box.empty());
  EXPECT_FALSE(box.contains(Vec3(0.0)));
  box.include(Vec3(1.0, 2.0, 3.0));
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.half_diagonal(), 0.0);
}

}  // namespace
}  // namespace outcrop

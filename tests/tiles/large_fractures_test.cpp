#include "outcrop/tiles/large_fractures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/field_contract.h"
#include "outcrop/core/error.h"
#include "outcrop/implicit/primitives.h"

namespace outcrop {
namespace {

const LargeFractureSet kSet{.kappa = 50.0, .spacing = 40.0, .length_lo = 30.0, .length_hi = 200.0};

bool same(const LargeFracture& a, const LargeFracture& b) {
  return a.centre == b.centre && a.normal == b.normal && a.radius == b.radius && a.width == b.width;
}

// Ground below z = 0 with gaps down to 10 m, tapering over the last 8.
FieldPtr gapped(std::vector<LargeFracture> fractures) {
  return with_gaps(half_space({{0, 0, 1}, 0.0}), std::move(fractures), {.floor = half_space({{0, 0, 1}, 10.0}), .taper = 8.0});
}

TEST(LargeFractures, AreTheSameWhateverTheBox) {
  const Box large{Vec3(-300.0), Vec3(300.0)}, small{{20.0, -10.0, 0.0}, {60.0, 30.0, 15.0}};
  const auto all = draw_large_fractures(kSet, large, Vec3(7.0), 3, 0);
  const auto some = draw_large_fractures(kSet, small, Vec3(7.0), 3, 0);
  ASSERT_FALSE(some.empty());
  EXPECT_LT(some.size(), all.size() / 4);
  for (const LargeFracture& f : some)
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const LargeFracture& g) { return same(f, g); }));
  // None is missed: a point of the small box within a disc's plane and rim belongs to one of the small box's.
  Rng rng(1, "large fractures test");
  for (const LargeFracture& f : all)
    for (int i = 0; i < 50; ++i) {
      Vec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = rng.uniform(small.lo[axis], small.hi[axis]);
      p -= glm::dot(f.normal, p - f.centre) * f.normal;
      if (!small.contains(p) || f.share(p) <= 0.0) continue;
      EXPECT_TRUE(std::any_of(some.begin(), some.end(), [&](const LargeFracture& g) { return same(f, g); }));
    }
}

TEST(LargeFractures, HaveTheSpacingOfTheirSet) {
  // Along a line with the mean normal a set of P32 is met P32 · E[cos] times a metre; κ = 50 gives E[cos] = coth κ − 1/κ.
  const Box box{Vec3(0.0), Vec3(2000.0)};
  const auto fractures = draw_large_fractures(kSet, box, Vec3(0.0), 11, 0);
  std::size_t hits = 0;
  double metres = 0.0;
  Rng rng(2, "large fractures test");
  for (int i = 0; i < 400; ++i) {
    const double y = rng.uniform(0.0, 2000.0);
    const double z = rng.uniform(0.0, 2000.0);
    metres += 2000.0;
    for (const LargeFracture& f : fractures) {
      const double x = f.centre.x - (f.normal.y * (y - f.centre.y) + f.normal.z * (z - f.centre.z)) / f.normal.x;
      hits += x >= 0.0 && x < 2000.0 && f.share({x, y, z}) > 0.0;
    }
  }
  const double expected = metres / 40.0 * (1.0 - 1.0 / 50.0);
  EXPECT_NEAR(static_cast<double>(hits), expected, 0.04 * expected);
}

TEST(LargeFractures, AreAWedgeThatOpensUpwards) {
  const FieldPtr field = gapped({{.centre = {0, 0, -2}, .normal = {1, 0, 0}, .radius = 100.0, .width = 3.0}});
  EXPECT_GT(field->value({0.0, 0.0, -1.0}), 0.0);
  EXPECT_GT(field->value({1.4, 0.0, -1.0}), 0.0);
  EXPECT_LT(field->value({1.6, 0.0, -1.0}), 0.0);
  EXPECT_NEAR(field->value({0.0, 0.0, -6.0}), 0.75, 0.01);  // half of the width, four metres above the floor
  EXPECT_LT(field->value({0.0, 0.0, -10.1}), 0.0);
  EXPECT_LT(field->value({0.0, 105.0, -1.0}), 0.0) << "beyond the rim";
  EXPECT_EQ(field->value({0.0, 0.0, 3.0}), 3.0) << "air stays as it was";
}

TEST(LargeFractures, PassTheFieldContract) {
  std::vector<LargeFracture> fractures = draw_large_fractures(
      {.normal = {0.6, 0.8, 0.0}, .kappa = 8.0, .spacing = 4.0, .length_lo = 8.0, .length_hi = 40.0, .width = 3.0},
      {Vec3(-20.0), Vec3(20.0)}, Vec3(0.0), 5, 0);
  ASSERT_GT(fractures.size(), 10u);
  test::check_field_contract(*gapped(std::move(fractures)), {Vec3(-18.0), Vec3(18.0)});
}

TEST(LargeFractures, LeaveWhatIsUntouchedAlone) {
  const FieldPtr ground = half_space({{0, 0, 1}, 0.0});
  const LargeFracture fracture{.radius = 50.0, .width = 2.0};
  const FieldPtr field = with_gaps(ground, {fracture},
                                   {.floor = ground, .untouched = [](const Box& box) { return box.lo.x > -5.0; }});
  Rng rng(3, "large fractures test");
  for (int i = 0; i < 200; ++i) {
    const double x = rng.uniform(-2.0, 2.0);
    const double z = rng.uniform(-4.0, 4.0);
    const Vec3 p(x, 0.0, z);
    EXPECT_EQ(field->value(p), ground->value(p)) << "a floor as high as the ground leaves its bits";
  }
  EXPECT_EQ(field->narrow({Vec3(-1.0), Vec3(1.0)}), ground);
}

TEST(LargeFractures, StepTheWallOnBothSides) {
  const LargeFracture fault{.centre = Vec3(0.0), .normal = {1, 0, 0}, .radius = 100.0, .step = 4.0};
  EXPECT_NEAR(setback(std::vector{fault}, {1e-9, 0, 0}), 2.0, 1e-6);
  EXPECT_NEAR(setback(std::vector{fault}, {-1e-9, 0, 0}), -2.0, 1e-6);
  EXPECT_NEAR(setback(std::vector{fault}, {50.0, 0, 0}), 1.0, 1e-6);
  EXPECT_EQ(setback(std::vector{fault}, {0.0, 100.0, 0.0}), 0.0);
}

TEST(LargeFractures, RefuseSetsThatMakeNoSense) {
  const auto refuses = [](const LargeFractureSet& set) {
    EXPECT_THROW((void)draw_large_fractures(set, {Vec3(0.0), Vec3(1.0)}, Vec3(0.0), 1, 0), ParameterError);
  };
  refuses({.normal = Vec3(2.0)});
  refuses({.kappa = 0.0});
  refuses({.spacing = 0.0});
  refuses({.length_lo = 10.0, .length_hi = 5.0});
  refuses({.spacing = 1e-9});
}

}  // namespace
}  // namespace outcrop

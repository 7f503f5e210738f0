#include "outcrop/implicit/relief.h"

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/field_contract.h"
#include "implicit/shapes.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

constexpr double kPeriod = 2.0;

[[nodiscard]] Vec2 random_place(Rng& rng) {
  const double u = rng.uniform(-3.0 * kPeriod, 3.0 * kPeriod);
  const double v = rng.uniform(-3.0 * kPeriod, 3.0 * kPeriod);
  return {u, v};
}

TEST(Relief, ReadsItsImageWithRowZeroOnTopAndInUnitsOfItsFullScale) {
  Image image = test::grey_image(8, 4);
  image.full_scale = 255.0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) image.at(x, y) = y == 0 ? 255.0f : 0.0f;  // A bright line along the image's top.
  const Relief relief(image, kPeriod);
  // The top row's centre is at v = period · 3.5 / 4, where a B-spline gives ¾ to the row itself.
  EXPECT_NEAR(relief.at(0.3, kPeriod * 3.5 / 4).d, 0.75, 1e-6);
  EXPECT_NEAR(relief.at(0.3, kPeriod * 1.5 / 4).d, 0.0, 1e-6);
  EXPECT_GT(relief.at(0.3, kPeriod * 3.0 / 4).dv, 0.0);
}

TEST(Relief, OfALinearRampIsTheRampWithItsSlope) {
  Image image = test::grey_image(16, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) image.at(x, y) = x / 32.0f;
  const Relief relief(image, kPeriod);
  const Relief::Sample sample = relief.at(kPeriod * 7.75 / 16, 0.4);
  EXPECT_NEAR(sample.d, 7.25 / 32.0, 1e-6);
  EXPECT_NEAR(sample.du, 0.5 / kPeriod, 1e-5);
  EXPECT_NEAR(sample.dv, 0.0, 1e-6);
}

TEST(Relief, RepeatsEveryPeriodAlsoFarFromTheOrigin) {
  const ReliefPtr relief = test::noise_relief(1, 32, 16, kPeriod);
  test::for_each_seed(100, [&](Seed seed) {
    Rng rng(seed, "places");
    const Vec2 p = random_place(rng);
    const Relief::Sample here = relief->at(p.x, p.y);
    const Relief::Sample there = relief->at(p.x + 2'600'000 * kPeriod, p.y - 7 * kPeriod);
    EXPECT_NEAR(here.d, there.d, 1e-5);
    EXPECT_NEAR(here.du, there.du, 1e-3);
  });
}

TEST(Relief, StaysInTheUnitIntervalBelowItsSlopeAndMatchesCentralDifferences) {
  for (const auto& [width, height] : {std::pair{32, 16}, std::pair{1, 5}, std::pair{2, 2}}) {
    const ReliefPtr relief = test::noise_relief(2, width, height, kPeriod);
    test::for_each_seed(300, [&, w = width, h = height](Seed seed) {
      Rng rng(seed, "places", static_cast<std::uint64_t>(w * 100 + h));
      const Vec2 p = random_place(rng);
      const Relief::Sample sample = relief->at(p.x, p.y);
      ASSERT_GE(sample.d, 0.0f);
      ASSERT_LE(sample.d, 1.0f + 1e-6f);
      ASSERT_LE(std::hypot(sample.du, sample.dv), relief->slope() * (1.0 + 1e-5));
      const double step = 1e-3;
      ASSERT_NEAR(sample.du, (relief->at(p.x + step, p.y).d - relief->at(p.x - step, p.y).d) / (2 * step),
                  0.02 * relief->slope());
      ASSERT_NEAR(sample.dv, (relief->at(p.x, p.y + step).d - relief->at(p.x, p.y - step).d) / (2 * step),
                  0.02 * relief->slope());
    });
  }
}

TEST(Relief, SlopeIsReachedByAnEdgeAcrossTheImage) {
  Image image = test::grey_image(32, 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 16; x < 32; ++x) image.at(x, y) = 1.0f;
  const Relief relief(image, kPeriod);
  EXPECT_NEAR(relief.at(kPeriod / 2, 0.7).du, relief.slope(), 1e-3 * relief.slope());
}

TEST(Relief, SmoothedKeepsLongFeaturesFadesShortOnesAndTendsToItsMean) {
  const int n = 64;
  Image image = test::grey_image(n, n);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      image.at(x, y) = static_cast<float>(0.5 + 0.2 * std::sin(2 * kPi * x / n) + 0.2 * std::sin(2 * kPi * 16 * y / n));
  const Relief relief(image, kPeriod);
  const Relief fine = relief.smoothed(kPeriod / 8);
  double long_part = 0.0, short_part = 0.0;
  for (int i = 0; i < n; ++i) {
    const double at = kPeriod * (i + 0.5) / n;
    long_part += fine.at(at, 0.0).d * std::sin(2 * kPi * i / n) * 2.0 / n;
    short_part += fine.at(0.0, kPeriod - at).d * std::sin(2 * kPi * 16 * i / n) * 2.0 / n;
  }
  EXPECT_GT(long_part, 0.18);             // A wave of eight lengths keeps nine tenths.
  EXPECT_LT(std::abs(short_part), 0.01);  // One of half a length keeps a twentieth at most.
  EXPECT_NEAR(fine.mean(), relief.mean(), 1e-5);

  double slope = relief.slope();
  for (const double length : {0.1, 0.5, 1.0, 2.0, 4.0}) {
    const double next = relief.smoothed(length).slope();
    EXPECT_LT(next, slope) << "length " << length;
    slope = next;
  }
  EXPECT_LT(slope, 0.01);
  const Relief flat = relief.smoothed(100.0);
  EXPECT_NEAR(flat.at(0.3, 0.9).d, relief.mean(), 1e-4);
  EXPECT_EQ(relief.smoothed(0.0).at(0.3, 0.9).d, relief.at(0.3, 0.9).d);
}

TEST(Relief, RefusesWhatItCannotUse) {
  EXPECT_THROW(Relief(test::grey_image(4, 4), 0.0), ParameterError);
  EXPECT_THROW(Relief(Image{}, 1.0), ParameterError);
  Image image = test::grey_image(4, 4);
  image.pixels[5] = std::nanf("");
  EXPECT_THROW(Relief(image, 1.0), ParameterError);
  EXPECT_THROW((void)read_relief("/nonexistent/relief.png", 1.0), InputError);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/core/rng.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace outcrop {
namespace {

constexpr int kDraws = 100'000;

TEST(Rng, GivesTheSameNumbersInEveryRelease) {
  // Fixed once: a change here changes every scene that anybody has saved.
  Rng rng(1, "test", 2);
  EXPECT_EQ(rng.next(), 6294769361971220836u);
  EXPECT_EQ(rng.next(), 12275366203319885008u);
}

TEST(Rng, StreamsDifferInSeedPurposeAndIndex) {
  std::set<std::uint64_t> firsts;
  for (Seed seed = 0; seed < 10; ++seed) {
    for (const char* purpose : {"", "discs", "disc", "samples"}) {
      for (std::uint64_t index = 0; index < 1000; ++index) firsts.insert(Rng(seed, purpose, index).next());
    }
  }
  EXPECT_EQ(firsts.size(), 40'000u);
}

TEST(Rng, NeighbouringStreamsAreNotCorrelated) {
  double sum = 0.0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    sum += (Rng(7, "a", i).uniform() - 0.5) * (Rng(7, "a", i + 1).uniform() - 0.5);
  }
  const double standard_error = 1.0 / 12.0 / std::sqrt(kDraws);
  EXPECT_LT(std::abs(sum / kDraws), 5.0 * standard_error);
}

TEST(Rng, UniformHasTheMomentsOfTheUnitInterval) {
  Rng rng(3, "uniform");
  double mean = 0.0, square = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = rng.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    mean += u / kDraws;
    square += u * u / kDraws;
  }
  EXPECT_NEAR(mean, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / kDraws));
  EXPECT_NEAR(square, 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / kDraws));
}

TEST(Rng, BelowIsEvenOverItsRange) {
  Rng rng(4, "below");
  std::vector<int> counts(7);
  for (int i = 0; i < kDraws; ++i) ++counts.at(rng.below(counts.size()));
  double chi_square = 0.0;
  for (const int n : counts) chi_square += std::pow(n - kDraws / 7.0, 2) / (kDraws / 7.0);
  EXPECT_LT(chi_square, 22.46);  // 6 degrees of freedom, one in a thousand
}

TEST(Rng, DirectionsAreUnitVectorsSpreadEvenly) {
  Rng rng(5, "directions");
  Vec3 mean(0.0), square(0.0);
  for (int i = 0; i < kDraws; ++i) {
    const Vec3 d = rng.direction();
    ASSERT_NEAR(glm::length(d), 1.0, 1e-14);
    mean += d / static_cast<double>(kDraws);
    square += d * d / static_cast<double>(kDraws);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(mean[axis], 0.0, 5.0 * std::sqrt(1.0 / 3.0 / kDraws));
    EXPECT_NEAR(square[axis], 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / kDraws));
  }
}

}  // namespace
}  // namespace outcrop

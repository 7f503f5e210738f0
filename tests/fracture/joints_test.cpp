#include "outcrop/fracture/joints.h"

#include <gtest/gtest.h>

#include <cmath>

#include "outcrop/core/error.h"
#include "outcrop/fracture/samples.h"

namespace outcrop {
namespace {

constexpr double kSide = 20.0;

TEST(FisherDirection, HasTheDistributionsMeanLength) {
  // Mean resultant coth κ − 1/κ; its standard error over n directions is below 1/√n.
  const Vec3 mean = glm::normalize(Vec3(1, -2, 3));
  for (const double kappa : {0.5, 5.0, 60.0, 1e4}) {
    const int n = 20'000;
    Vec3 sum{0.0};
    for (int i = 0; i < n; ++i) {
      Rng rng(1, "fisher", static_cast<std::uint64_t>(i));
      const Vec3 d = fisher_direction(mean, kappa, rng);
      ASSERT_NEAR(glm::length(d), 1.0, 1e-12);
      sum += d;
    }
    const double expected = 1.0 / std::tanh(kappa) - 1.0 / kappa;
    EXPECT_NEAR(glm::dot(sum / double(n), mean), expected, 4.0 * (1.0 - expected + 1e-6) / std::sqrt(n) + 1e-6)
        << kappa;
    EXPECT_LT(glm::length(glm::cross(sum / double(n), mean)), 4.0 / std::sqrt(n)) << kappa;
  }
}

TEST(FisherDirection, StaysFiniteAtExtremeConcentrations) {
  for (const double kappa : {1e-9, 800.0, 1e9})
    for (std::uint64_t i = 0; i < 100; ++i) {
      Rng rng(2, "fisher", i);
      const Vec3 d = fisher_direction({0, 0, -1}, kappa, rng);
      ASSERT_TRUE(std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.z)) << kappa;
    }
}

TEST(DrawDiscs, FollowTheirPatternForEveryType) {
  for (const BlockType type : kBlockTypes)
    for (Seed seed = 1; seed <= 5; ++seed) {
      const JointPattern pattern = joint_pattern(type);
      const auto discs = draw_discs(pattern, kSide, seed);
      ASSERT_EQ(discs.size(), static_cast<std::size_t>(pattern.discs)) << name(type);
      std::vector<int> of_set(pattern.sets.size(), 0);
      int irregular = 0;
      double last = 1e300;
      for (const Disc& disc : discs) {
        ASSERT_LE(disc.radius, last) << "largest first";
        last = disc.radius;
        ASSERT_NEAR(glm::length(disc.normal), 1.0, 1e-12);
        for (int axis = 0; axis < 3; ++axis) ASSERT_TRUE(disc.centre[axis] >= 0.0 && disc.centre[axis] < kSide);
        if (disc.set < 0) {
          ++irregular;
          continue;
        }
        const JointSet& set = pattern.sets[static_cast<std::size_t>(disc.set)];
        ASSERT_TRUE(disc.radius >= set.radius_lo && disc.radius <= set.radius_hi);
        ++of_set[static_cast<std::size_t>(disc.set)];
      }
      EXPECT_NEAR(irregular, pattern.irregular_share * pattern.discs, 0.5001) << name(type);
      double shares = 0.0;
      for (const JointSet& set : pattern.sets) shares += set.share;
      for (std::size_t s = 0; s < of_set.size(); ++s)
        EXPECT_NEAR(of_set[s], pattern.sets[s].share / shares * pattern.discs, 1.0 + irregular) << name(type);
    }
}

TEST(DrawDiscs, SpreadTheCentresOfASetWhereThereIsRoom) {
  for (Seed seed = 1; seed <= 8; ++seed) {
    const auto discs = draw_discs(joint_pattern(BlockType::Polyhedral), kSide, seed);
    for (std::size_t i = 0; i < discs.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) ASSERT_GE(wrapped_distance(discs[i].centre, discs[j].centre, kSide), 1.0);
  }
}

TEST(DrawDiscs, ScaleWithTheTile) {
  const auto small = draw_discs(joint_pattern(BlockType::Equidimensional, 5.0), 5.0, 3);
  const auto large = draw_discs(joint_pattern(BlockType::Equidimensional, 40.0), 40.0, 3);
  ASSERT_EQ(small.size(), large.size());
  for (std::size_t i = 0; i < small.size(); ++i) {
    EXPECT_NEAR(8.0 * small[i].radius, large[i].radius, 1e-9);
    EXPECT_NEAR(glm::length(8.0 * small[i].centre - large[i].centre), 0.0, 1e-9);
  }
}

TEST(DrawDiscs, MeetScanLinesAsTheirIntensitySays) {
  // P10 along t is P32 E|n · t|: 1/2 for uniform normals. Lines along an axis of the torus close, so there is no
  // border.
  const JointPattern pattern{.sets = {{.kappa = 1.0, .radius_lo = 1.0, .radius_hi = 3.0}},
                             .discs = 2000,
                             .irregular_share = 1.0,
                             .centre_spacing = 0.0};
  const auto discs = draw_discs(pattern, kSide, 4);
  std::size_t hits = 0;
  const int lines = 400;
  for (int line = 0; line < lines; ++line) {
    Rng rng(4, "lines", static_cast<std::uint64_t>(line));
    const double x = kSide * rng.uniform();
    const double y = kSide * rng.uniform();
    for (const Disc& disc : discs) {
      const Vec3 d = wrapped_difference(disc.centre, {x, y, disc.centre.z}, kSide);
      const double z = -(disc.normal.x * d.x + disc.normal.y * d.y) / disc.normal.z;
      hits += d.x * d.x + d.y * d.y + z * z <= disc.radius * disc.radius;
    }
  }
  const double p10 = static_cast<double>(hits) / (lines * kSide);
  EXPECT_NEAR(p10, 0.5 * intensity(discs, kSide), 0.03 * p10);
}

TEST(DrawDiscs, RefusePatternsThatMakeNoSense) {
  const auto refuses = [](auto&& change) {
    JointPattern pattern = joint_pattern(BlockType::Tabular);
    change(pattern);
    EXPECT_THROW((void)draw_discs(pattern, kSide, 1), ParameterError);
  };
  refuses([](JointPattern& p) { p.discs = -1; });
  refuses([](JointPattern& p) { p.irregular_share = 1.5; });
  refuses([](JointPattern& p) { p.sets[0].kappa = 0.0; });
  refuses([](JointPattern& p) { p.sets[0].radius_hi = 0.5 * p.sets[0].radius_lo; });
  refuses([](JointPattern& p) { p.sets[0].radius_lo = 0.0; });
  refuses([](JointPattern& p) { p.sets[0].normal = {1, 1, 1}; });
  refuses([](JointPattern& p) { p.sets.clear(); });
  refuses([](JointPattern& p) { p.least_thickness = NAN; });
  EXPECT_THROW((void)draw_discs(joint_pattern(BlockType::Tabular), 0.0, 1), ParameterError);
}

}  // namespace
}  // namespace outcrop

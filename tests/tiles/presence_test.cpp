#include "outcrop/tiles/presence.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

std::vector<Anchor> walls_and_floors(int walls, int floors) {
  std::vector<Anchor> anchors;
  for (int i = 0; i < walls; ++i) anchors.push_back({.position = {}, .distance = -1.0, .slope = 1.4, .material = 2});
  for (int i = 0; i < floors; ++i) anchors.push_back({.position = {}, .distance = -1.0, .slope = 0.1, .material = 2});
  return anchors;
}

TEST(Presence, HalfOfTheAnchorsIsEnough) {
  const Criterion steep = slope_at_least(radians(45));
  EXPECT_TRUE(present(steep, walls_and_floors(2, 2)));
  EXPECT_FALSE(present(steep, walls_and_floors(2, 3)));
  EXPECT_TRUE(present(steep, walls_and_floors(1, 0)));
}

TEST(Presence, WithoutAnchorsThereIsNoBlock) { EXPECT_FALSE(present(slope_at_least(0.0), {})); }

TEST(Presence, CriteriaCombine) {
  const Anchor anchor{.position = {}, .distance = -3.0, .slope = 1.0, .material = 4};
  EXPECT_TRUE(distance_between(-4.0, 0.0)(anchor));
  EXPECT_FALSE(distance_between(-2.0, 0.0)(anchor));
  EXPECT_TRUE(material_is(4)(anchor));
  EXPECT_FALSE(material_is(3)(anchor));
  EXPECT_FALSE(all_of({material_is(4), distance_between(-2.0, 0.0)})(anchor));
  EXPECT_TRUE(any_of({material_is(3), distance_between(-4.0, 0.0)})(anchor));
  EXPECT_TRUE(none_of({material_is(3), distance_between(-2.0, 0.0)})(anchor));
  EXPECT_TRUE(all_of({})(anchor));
  EXPECT_FALSE(any_of({})(anchor));
}

TEST(Presence, TheMeanWeightIsOverTheAnchors) {
  const Weight steep = [](const Anchor& anchor) { return anchor.slope > 1.0 ? 1.0 : 0.2; };
  EXPECT_DOUBLE_EQ(mean_weight(steep, walls_and_floors(1, 3)), 0.4);
  EXPECT_EQ(mean_weight(steep, {}), 0.0);
}

TEST(Presence, AWeightLeavesThatShareOfTheBlocksAndDropsSmallOnesFirst) {
  constexpr int kBlocks = 100, kCopies = 400;
  for (const double weight : {0.1, 0.3, 0.5, 0.9}) {
    std::vector<int> standing(kBlocks);
    int all = 0;
    for (int block = 0; block < kBlocks; ++block)
      for (int copy = 0; copy < kCopies; ++copy) {
        Rng rng(1, "presence test", static_cast<std::uint64_t>(block) * kCopies + copy);
        const bool stands = drop_threshold((block + 0.5) / kBlocks, rng.uniform()) < weight;
        standing[block] += stands;
        all += stands;
      }
    EXPECT_NEAR(all / double(kBlocks * kCopies), weight, 0.01);
    const auto in = [&](int first) { return std::accumulate(&standing[first], &standing[first] + 20, 0); };
    for (int first = 0; first + 40 <= kBlocks; first += 20) EXPECT_GE(in(first), in(first + 20)) << weight;
    EXPECT_TRUE(weight > 0.5 || in(0) > 2 * in(80));
  }
}

}  // namespace
}  // namespace outcrop

#include "outcrop/tiles/presence.h"

#include <gtest/gtest.h>

#include <vector>

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

}  // namespace
}  // namespace outcrop

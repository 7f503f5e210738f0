#include "distance_transform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

TEST(DistanceToMarked, EqualsTheNearestOfAllMarkedNodes) {
  for (const double share : {0.0, 0.002, 0.02, 0.5, 1.0}) {
    constexpr int kWidth = 61, kHeight = 47;
    constexpr float kFarthest = 17.5f;
    Rng rng(1, "distance transform test", static_cast<std::uint64_t>(share * 1000.0));
    std::vector<char> marked(kWidth * kHeight);
    for (char& m : marked) m = rng.uniform() < share;
    const std::vector<float> distances = distance_to_marked(kWidth, kHeight, marked, kFarthest);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        float nearest = kFarthest;
        for (int i = 0; i < kWidth * kHeight; ++i)
          if (marked[i]) nearest = std::min(nearest, std::hypot(float(i % kWidth - x), float(i / kWidth - y)));
        ASSERT_NEAR(distances[y * kWidth + x], nearest, 1e-5f) << x << ' ' << y << " of " << share;
      }
  }
}

}  // namespace
}  // namespace outcrop

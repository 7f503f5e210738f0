#include "outcrop/terrain/distance_transform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

TEST(DistanceToMarked, EqualsTheNearestOfAllMarkedNodes) {
  constexpr int kWidth = 61, kHeight = 47;
  const Vec2 cell(0.7, 1.3);
  for (const double share : {0.0, 0.002, 0.02, 0.5, 1.0})
    for (const double farthest : {17.5, std::numeric_limits<double>::infinity()}) {
      Rng rng(1, "distance transform test", static_cast<std::uint64_t>(share * 1000.0));
      std::vector<char> marked(kWidth * kHeight);
      for (char& m : marked) m = rng.uniform() < share;
      const std::vector<double> distances = distance_to_marked(kWidth, kHeight, cell, marked, farthest);
      const std::vector<float> floats = distance_to_marked(kWidth, kHeight, cell, marked, static_cast<float>(farthest));
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          double nearest = farthest;
          for (int i = 0; i < kWidth * kHeight; ++i)
            if (marked[i]) nearest = std::min(nearest, glm::length(cell * Vec2(i % kWidth - x, i / kWidth - y)));
          const double got = distances[y * kWidth + x];
          ASSERT_TRUE(got == nearest || std::abs(got - nearest) < 1e-9) << x << ' ' << y << " of " << share;
          ASSERT_FLOAT_EQ(floats[y * kWidth + x], static_cast<float>(nearest));
        }
    }
}

}  // namespace
}  // namespace outcrop

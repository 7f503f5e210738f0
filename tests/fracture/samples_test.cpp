#include "outcrop/fracture/samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

TEST(PoissonSamples, KeepTheirSpacingAcrossTheTileBorder) {
  for (Seed seed = 1; seed <= 8; ++seed) {
    const double side = 4.0;
    const double spacing = 0.45;
    const auto samples = poisson_samples(side, spacing, seed);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) ASSERT_TRUE(samples[i][axis] >= 0.0 && samples[i][axis] < side);
      for (std::size_t j = 0; j < i; ++j) ASSERT_GE(wrapped_distance(samples[i], samples[j], side), spacing);
    }
  }
}

TEST(PoissonSamples, LeaveNoRoomForAnother) {
  const double side = 5.0;
  const double spacing = 0.5;
  const auto samples = poisson_samples(side, spacing, 3);
  Rng rng(3, "probes");
  for (int i = 0; i < 3000; ++i) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = side * rng.uniform();
    double nearest = side;
    for (const Vec3& s : samples) nearest = std::min(nearest, wrapped_distance(p, s, side));
    ASSERT_LE(nearest, spacing * (1.0 + 1e-5));
  }
}

TEST(PoissonSamples, HaveTheJammingDensityWhateverTheSide) {
  // Random sequential packing of spheres jams at a volume share of 0.384: n = 0.384 · 6/π (side / spacing)³.
  for (const double side : {2.0, 20.0, 300.0}) {
    const auto count = static_cast<double>(poisson_samples(side, side / 14.0, 5).size());
    EXPECT_NEAR(count, 0.384 * 6.0 / kPi * 14.0 * 14.0 * 14.0, 0.04 * count);
  }
}

TEST(PoissonSamples, ShowNeitherADirectionNorTheGridTheyAreMadeIn) {
  const double side = 10.0;
  const double spacing = 0.4;
  const double cells = std::ceil(side * std::sqrt(3.0) / spacing);
  Mat3 directions(0.0);  // the mean of d dᵀ over neighbours: a third of the identity
  Vec3 phase(0.0);       // of places in half cells: 0 for even ones, up to 1 for rows of equal ones
  double pairs = 0.0;
  double count = 0.0;
  for (Seed seed = 1; seed <= 4; ++seed) {
    const auto samples = poisson_samples(side, spacing, seed);
    const Graph graph = neighbour_graph(samples, side, 1.2 * spacing);
    for (std::uint32_t i = 0; i < samples.size(); ++i, count += 1.0) {
      phase += glm::cos(4.0 * kPi * cells / side * samples[i]);
      for (std::uint32_t e = graph.first[i]; e < graph.first[i + 1]; ++e, pairs += 1.0) {
        const Vec3 d = glm::normalize(wrapped_difference(samples[i], samples[graph.targets[e]], side));
        directions += glm::outerProduct(d, d);
      }
    }
  }
  for (int row = 0; row < 3; ++row) {
    EXPECT_LT(std::abs(phase[row] / count), 0.06);
    for (int column = 0; column < 3; ++column)
      EXPECT_NEAR(directions[column][row] / pairs, row == column ? 1.0 / 3.0 : 0.0, 0.003);
  }
}

TEST(PoissonSamples, AreTheSameForTheSameSeedAndOthersForAnother) {
  EXPECT_EQ(poisson_samples(10.0, 1.0, 7), poisson_samples(10.0, 1.0, 7));
  EXPECT_NE(poisson_samples(10.0, 1.0, 7), poisson_samples(10.0, 1.0, 8));
}

TEST(PoissonSamples, RefuseSpacingsThatMakeNoSense) {
  EXPECT_THROW((void)poisson_samples(1.0, 0.0, 1), ParameterError);
  EXPECT_THROW((void)poisson_samples(1.0, 0.3, 1), ParameterError);
  EXPECT_THROW((void)poisson_samples(1.0, 1e-3, 1), ParameterError);
  EXPECT_THROW((void)poisson_samples(-1.0, 0.1, 1), ParameterError);
  EXPECT_THROW((void)poisson_samples(NAN, 0.1, 1), ParameterError);
}

TEST(WrappedDifference, IsTheShortestOfAllImages) {
  Rng rng(1, "pairs");
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = 5.0 * (rng.direction() + 1.0);
    const Vec3 b = 5.0 * (rng.direction() + 1.0);
    double least = 1e300;
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        for (int z = -2; z <= 2; ++z) least = std::min(least, glm::length(b - a + 10.0 * Vec3(x, y, z)));
    ASSERT_NEAR(wrapped_distance(a, b, 10.0), least, 1e-12);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_GE(wrapped_difference(a, b, 10.0)[axis], -5.0);
      ASSERT_LT(wrapped_difference(a, b, 10.0)[axis], 5.0);
    }
  }
}

TEST(NeighbourGraph, HoldsExactlyThePairsWithinTheRadius) {
  const double side = 6.0;
  const auto samples = poisson_samples(side, 0.8, 2);
  for (const double radius : {0.9, 1.3, 2.9}) {
    const Graph graph = neighbour_graph(samples, side, radius);
    ASSERT_EQ(graph.first.size(), samples.size() + 1);
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t j = 0; j < samples.size(); ++j)
        if (j != i && wrapped_distance(samples[i], samples[j], side) <= radius) expected.push_back(j);
      std::vector<std::uint32_t> found(graph.targets.begin() + graph.first[i],
                                       graph.targets.begin() + graph.first[i + 1]);
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected) << "sample " << i << ", radius " << radius;
    }
  }
}

}  // namespace
}  // namespace outcrop

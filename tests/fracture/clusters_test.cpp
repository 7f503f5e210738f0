#include "outcrop/fracture/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace outcrop {
namespace {

constexpr double kSide = 20.0;
constexpr double kSpacing = 1.1;  // Some 4 400 samples: quick, and plenty for the geometry.

ClusterOptions options_of(const JointPattern& pattern) {
  return {.side = kSide,
          .sight = 1.6 * kSpacing,
          .min_samples = 4,
          .min_inradius = std::max(0.3, 0.5 * pattern.least_thickness),
          .covered_share = pattern.covered_share,
          .least_angle = pattern.least_angle,
          .longest = 19.0,
          .columns = pattern.columns,
          .sets = pattern.sets};
}

struct Case {
  std::vector<Vec3> samples;
  std::vector<Disc> discs;
  Clusters clusters;
};

Case split(const JointPattern& pattern, Seed seed) {
  Case c;
  c.samples = poisson_samples(kSide, kSpacing, seed);
  c.discs = draw_discs(pattern, kSide, seed);
  c.clusters =
      split_samples(c.samples, neighbour_graph(c.samples, kSide, 1.6 * kSpacing), c.discs, options_of(pattern), seed);
  return c;
}

bool contains(const Polytope& shape, const Vec3& p, double slack) {
  return std::all_of(shape.faces.begin(), shape.faces.end(),
                     [&](const Polytope::Face& face) { return face.plane.distance(p) <= slack; });
}

// Cells tile the torus when their volumes add up to it and random points lie in one image of one cell.
void expect_tiling(const Case& c, Seed seed) {
  double volume = 0.0;
  for (const Cluster& cluster : c.clusters.list) volume += cluster.shape.volume();
  ASSERT_NEAR(volume, kSide * kSide * kSide, 1e-6);
  Rng rng(seed, "probes");
  for (int probe = 0; probe < 100; ++probe) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = kSide * rng.uniform();
    int covers = 0;
    for (const Cluster& cluster : c.clusters.list) {
      const Box bounds = cluster.shape.bounds();
      const Vec3 lo = glm::ceil((bounds.lo - p) / kSide);
      const Vec3 hi = glm::floor((bounds.hi - p) / kSide);
      for (double z = lo.z; z <= hi.z; ++z)
        for (double y = lo.y; y <= hi.y; ++y)
          for (double x = lo.x; x <= hi.x; ++x) covers += contains(cluster.shape, p + kSide * Vec3(x, y, z), 0.0);
    }
    ASSERT_EQ(covers, 1);
  }
}

void expect_all_samples(const Case& c) {
  std::vector<int> uses(c.samples.size(), 0);
  for (const Cluster& cluster : c.clusters.list) {
    ASSERT_FALSE(cluster.samples.empty());
    ASSERT_EQ(cluster.samples.size(), cluster.positions.size());
    for (std::size_t k = 0; k < cluster.samples.size(); ++k) {
      ++uses[cluster.samples[k]];
      ASSERT_TRUE(contains(cluster.shape, cluster.positions[k], 1e-9));
      const Vec3 tiles = (cluster.positions[k] - c.samples[cluster.samples[k]]) / kSide;
      ASSERT_LT(glm::length(tiles - glm::round(tiles)), 1e-12);
    }
  }
  for (const int use : uses) ASSERT_EQ(use, 1);
}

TEST(Clusters, TileTheTorusAndHoldEverySampleOnceForEveryType) {
  for (const BlockType type : kBlockTypes)
    for (Seed seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(std::string(name(type)) + ", seed " + std::to_string(seed));
      const Case c = split(joint_pattern(type), seed);
      expect_tiling(c, seed);
      expect_all_samples(c);
    }
}

TEST(Clusters, TileTheTorusWhateverTheJoints) {
  const auto set = [](const Vec3& normal, double kappa, double radius) {
    return JointSet{.normal = glm::normalize(normal), .kappa = kappa, .radius_lo = radius, .radius_hi = radius};
  };
  const auto persistent = [](const char* name, const Vec3& normal, double spacing, std::vector<std::string> ends_at) {
    return JointSet{.name = name,
                    .normal = glm::normalize(normal),
                    .kappa = 60,
                    .spacing = spacing,
                    .radius_law = RadiusLaw::Persistent,
                    .ends_at = std::move(ends_at)};
  };
  const std::vector<JointPattern> patterns{
      {.sets = {set({0, 0, 1}, 300, 5)}, .discs = 0},
      {.sets = {set({0, 0, 1}, 300, 5)}, .discs = 1},
      {.sets = {set({0, 0, 1}, 1e8, 30)}, .discs = 12},
      {.sets = {set({0.3, 0.5, 0.8}, 1e8, 12)}, .discs = 20},
      {.sets = {set({0.9, 0.1, 0.2}, 500, 25), set({0.8, -0.3, 0.3}, 500, 4)}, .discs = 30},
      {.sets = {set({1, 1, 1}, 400, 3)}, .discs = 200, .columns = {{.width = 1.5}}},
      {.sets = {set({1, 0, 0}, 400, 3)}, .discs = 40, .columns = {{.width = 4.0}}},
      {.sets = {set({0, 0, 1}, 0.1, 60)}, .discs = 60},
      {.sets = {persistent("a", {1, 1, 0.2}, 1.5, {}), persistent("b", {1, -1, 0}, 6, {"a"}),
                persistent("c", {0.1, 0.5, 1}, 2, {"a", "b"})}},
      {.sets = {persistent("a", {0, 0, 1}, 0.8, {}), set({1, 0, 0}, 50, 2)}, .discs = 40},
      {.sets = {persistent("a", {0.1, 0.4, 1}, 3, {std::string(kColumns)})},
       .columns = {{.width = 2.5, .height = 2.0}, {.width = 2.0, .irregularity = 0.8}}},
      {.sets = {set({1, 0, 0}, 50, 5)},
       .discs_at = {{.centre = {19, 1, 10}, .radius = 8.0, .normal = glm::normalize(Vec3(1, 2, 3))}}}};
  for (std::size_t i = 0; i < patterns.size(); ++i)
    for (Seed seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE("pattern " + std::to_string(i) + ", seed " + std::to_string(seed));
      const Case c = split(patterns[i], seed);
      expect_tiling(c, seed);
      expect_all_samples(c);
    }
}

TEST(Clusters, AreBoundedByJointsAlone) {
  for (const BlockType type : kBlockTypes) {
    const Case c = split(joint_pattern(type), 2);
    for (const Cluster& cluster : c.clusters.list)
      for (const Polytope::Face& face : cluster.shape.faces) {
        ASSERT_TRUE(face.joint >= 0 || face.joint == kAddedJoint || face.joint == kColumnJoint) << name(type);
        if (face.joint < 0) continue;
        const Disc& disc = c.clusters.discs[static_cast<std::size_t>(face.joint)];
        const double turn = std::acos(std::min(1.0, std::abs(glm::dot(disc.normal, face.plane.normal))));
        ASSERT_LE(turn, c.clusters.largest_bend + 1e-6) << name(type);
        // The face's plane passes through an image of the disc's centre.
        double nearest = 1e300;
        for (int z = -3; z <= 3; ++z)
          for (int y = -3; y <= 3; ++y)
            for (int x = -3; x <= 3; ++x)
              nearest = std::min(nearest, std::abs(face.plane.distance(disc.centre + kSide * Vec3(x, y, z))));
        ASSERT_LT(nearest, 1e-9) << name(type);
      }
  }
}

TEST(Clusters, TurnTwoDiscsAtMostAndOnlyALittle) {
  for (const BlockType type : {BlockType::Equidimensional, BlockType::Rhombohedral, BlockType::Polyhedral})
    for (Seed seed = 1; seed <= 4; ++seed) {
      const Case c = split(joint_pattern(type), seed);
      EXPECT_LT(c.clusters.largest_bend, radians(12.0)) << name(type);
      std::vector<bool> turned(c.discs.size(), false);
      for (const Cluster& cluster : c.clusters.list)
        for (const Polytope::Face& face : cluster.shape.faces)
          if (face.joint >= 0) {
            const auto i = static_cast<std::size_t>(face.joint);
            turned[i] = turned[i] || std::abs(glm::dot(c.discs[i].normal, face.plane.normal)) < 1.0 - 1e-9;
          }
      EXPECT_LE(std::count(turned.begin(), turned.end(), true), 2) << name(type);
    }
}

TEST(Clusters, DoNotDependOnTheOrderOfTheSamples) {
  for (const BlockType type : {BlockType::Polyhedral, BlockType::Tabular, BlockType::Columnar}) {
    const JointPattern pattern = joint_pattern(type);
    const Case c = split(pattern, 3);
    std::vector<Vec3> mixed = c.samples;
    Rng rng(3, "order");
    for (std::size_t i = mixed.size() - 1; i > 0; --i) std::swap(mixed[i], mixed[rng.below(i + 1)]);
    const Clusters other =
        split_samples(mixed, neighbour_graph(mixed, kSide, 1.6 * kSpacing), c.discs, options_of(pattern), 3);
    ASSERT_EQ(other.list.size(), c.clusters.list.size());
    const auto less = [](const Vec3& a, const Vec3& b) {
      return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    };
    for (std::size_t i = 0; i < other.list.size(); ++i) {
      ASSERT_EQ(other.list[i].shape.vertices, c.clusters.list[i].shape.vertices);
      std::vector<Vec3> a = other.list[i].positions;
      std::vector<Vec3> b = c.clusters.list[i].positions;
      std::sort(a.begin(), a.end(), less);
      std::sort(b.begin(), b.end(), less);
      ASSERT_EQ(a, b);
    }
  }
}

TEST(Clusters, KeepPiecesThatWouldBeChipsBladesOrSpikes) {
  JointPattern pattern = joint_pattern(BlockType::Polyhedral);
  for (Seed seed = 1; seed <= 4; ++seed) {
    const Case c = split(pattern, seed);
    EXPECT_GT(c.clusters.stopped_joints, 0u);
    std::size_t small = 0;
    for (const Cluster& cluster : c.clusters.list) small += cluster.samples.size() < 4;
    EXPECT_LE(small, c.clusters.added_joints) << "only halving a long cell may leave so few";
    for (const Cluster& cluster : c.clusters.list) {
      const Vec3 size = cluster.shape.bounds().size();
      EXPECT_LE(std::max(size.x, std::max(size.y, size.z)), 19.0);
    }
  }
}

}  // namespace
}  // namespace outcrop

// Where joints end, and what cuts before what.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/scratch.h"
#include "outcrop/core/error.h"
#include "outcrop/fracture/clusters.h"

namespace outcrop {
namespace {

constexpr double kSide = 20.0;

JointSet persistent(const char* name, const Vec3& normal, double spacing, std::vector<std::string> ends_at = {}) {
  return {.name = name,
          .normal = glm::normalize(normal),
          .kappa = 300.0,
          .spacing = spacing,
          .radius_law = RadiusLaw::Persistent,
          .ends_at = std::move(ends_at)};
}

JointSet discs(const char* name, const Vec3& normal, double p32, double radius, std::vector<std::string> ends_at = {}) {
  return {.name = name,
          .normal = glm::normalize(normal),
          .kappa = 100.0,
          .p32 = p32,
          .radius_lo = radius,
          .radius_hi = radius,
          .ends_at = std::move(ends_at)};
}

Clusters split(const JointPattern& pattern, double side, Domain domain, Seed seed, int min_samples = 1) {
  const double spacing = side / 18.0;
  const auto samples = poisson_samples(side, spacing, seed);
  const ClusterOptions options{.side = side,
                               .sight = 1.6 * spacing,
                               .min_samples = min_samples,
                               .min_inradius = 0.0,
                               .longest = 2.0 * side,
                               .columns = pattern.columns,
                               .sets = pattern.sets,
                               .domain = domain};
  return split_samples(samples, neighbour_graph(samples, side, 1.6 * spacing), draw_discs(pattern, side, seed, domain),
                       options, seed);
}

double area_of(const Polytope& shape, const Polytope::Face& face) {
  Vec3 twice{0.0};
  const Vec3& o = shape.vertices[face.loop[0]];
  for (std::size_t i = 2; i < face.loop.size(); ++i)
    twice += glm::cross(shape.vertices[face.loop[i - 1]] - o, shape.vertices[face.loop[i]] - o);
  return 0.5 * glm::length(twice);
}

// Between which persistent joints of a set a point lies.
std::vector<bool> sides_of(const Vec3& p, const std::vector<Disc>& all, int set) {
  std::vector<bool> sides;
  for (const Disc& disc : all)
    if (disc.set == set) sides.push_back(glm::dot(disc.normal, p - disc.centre) > 0.0);
  return sides;
}

// The areas of a set's joints in a box, and of those of them that lie on both sides of some persistent joint of another.
std::pair<double, double> area_and_passing(const Clusters& clusters, int set, int other) {
  std::map<int, std::set<std::vector<bool>>> where;
  std::map<int, double> areas;
  for (const Cluster& cluster : clusters.list)
    for (const Polytope::Face& face : cluster.shape.faces)
      if (face.joint >= 0 && clusters.discs[static_cast<std::size_t>(face.joint)].set == set) {
        where[face.joint].insert(sides_of(cluster.shape.middle(), clusters.discs, other));
        areas[face.joint] += area_of(cluster.shape, face);
      }
  double all = 0.0;
  double passing = 0.0;
  for (const auto& [joint, area] : areas) {
    all += area;
    if (where[joint].size() > 1) passing += area;
  }
  return {all, passing};
}

TEST(Terminations, StopPersistentJointsAtOlderOnes) {
  for (Seed seed = 1; seed <= 5; ++seed)
    for (const bool ends : {false, true}) {
      const std::vector<std::string> at = ends ? std::vector<std::string>{"beds"} : std::vector<std::string>{};
      const JointPattern pattern{.sets = {persistent("young", {1, 0.1, 0}, 2.5, at), persistent("beds", {0, 0.1, 1}, 3.0),
                                          persistent("through", {0, 1, 0}, 4.0)}};
      const auto [all, passing] = area_and_passing(split(pattern, 12.0, Domain::Box, seed, 0), 0, 1);
      EXPECT_GT(all, 50.0);
      if (ends)
        EXPECT_EQ(passing, 0.0);
      else
        EXPECT_GT(passing, 0.8 * all);
    }
}

TEST(Terminations, GoOnWhereTheyAreNotNamed) {
  // A joint that ends at beds crosses a third set without a step: it is one plane on both sides.
  const JointPattern pattern{.sets = {persistent("beds", {0, 0, 1}, 4.0), persistent("through", {0, 1, 0}, 4.0),
                                      persistent("young", {1, 0, 0}, 2.5, {"beds"})}};
  for (Seed seed = 1; seed <= 5; ++seed) {
    const auto [all, passing] = area_and_passing(split(pattern, 12.0, Domain::Box, seed, 0), 2, 1);
    EXPECT_GT(passing, 0.8 * all);
  }
}

TEST(Terminations, HoldForTheShareAskedFor) {
  JointPattern pattern{.sets = {persistent("beds", {0, 0, 1}, 2.0), persistent("young", {1, 0, 0}, 1.0, {"beds"}),
                                persistent("through", {0, 1, 0}, 6.0)}};
  pattern.sets[1].ends_share = 0.4;
  double all = 0.0, passing = 0.0;
  for (Seed seed = 1; seed <= 20; ++seed) {
    const auto [area, through] = area_and_passing(split(pattern, 14.0, Domain::Box, seed, 0), 1, 0);
    all += area;
    passing += through;
  }
  EXPECT_NEAR(passing / all, 0.6, 0.06);
  // Every face has two sides; 1/S on average whether joints end or not.
  EXPECT_NEAR(0.5 * all / (20 * std::pow(14.0, 3)), 1.0, 0.06);
}

TEST(Terminations, StopDiscsAtOlderOnes) {
  for (Seed seed = 1; seed <= 4; ++seed)
    for (const bool ends : {false, true}) {
      const std::vector<std::string> at = ends ? std::vector<std::string>{"beds"} : std::vector<std::string>{};
      const JointPattern pattern{.sets = {persistent("beds", {0.1, 0, 1}, 2.5), discs("a", {1, 0, 0}, 0.4, 3.0, at),
                                          discs("b", {0, 1, 0}, 0.4, 3.0, at)}};
      const Clusters clusters = split(pattern, 12.0, Domain::Box, seed);
      std::size_t near = 0, beyond = 0;
      for (const Cluster& cluster : clusters.list)
        for (const Polytope::Face& face : cluster.shape.faces) {
          if (face.joint < 0) continue;
          const Disc& disc = clusters.discs[static_cast<std::size_t>(face.joint)];
          const bool is_inside = Box{Vec3(0.0), Vec3(12.0)}.contains(disc.centre);  // beyond the walls there are no beds
          if (disc.set == 0 || !is_inside) continue;
          const bool same = sides_of(disc.centre, clusters.discs, 0) == sides_of(cluster.shape.middle(), clusters.discs, 0);
          ++(same ? near : beyond);
        }
      EXPECT_GT(near, 50u);
      if (ends)
        EXPECT_EQ(beyond, 0u);
      else
        EXPECT_GT(beyond, 10u);
    }
}

TEST(Terminations, NameTheCycleThatHasNoOldest) {
  const std::vector<JointSet> sets{persistent("a", {1, 0, 0}, 2.0, {"b"}), persistent("b", {0, 1, 0}, 2.0, {"c"}),
                                   persistent("c", {0, 0, 1}, 2.0, {"d", "b"}), persistent("d", {1, 1, 1}, 2.0)};
  EXPECT_EQ(termination_cycle(sets), R"("b" ends at "c" ends at "b")");
  EXPECT_NE(test::message_of<ParameterError>([&] { (void)joint_ages(sets); }).find("cycle"), std::string::npos);
  EXPECT_EQ(joint_ages({sets[3], persistent("e", {0, 0, 1}, 2.0, {"f"}), persistent("f", {0, 1, 0}, 2.0, {"d"})}),
            (std::vector<int>{0, 2, 1}));
}

TEST(DiscsByHand, PartTheRockBeforeAllOthersAndKeepTheirPlane) {
  for (const BlockType type : kBlockTypes) {
    if (type == BlockType::Columnar) continue;  // columns are there first
    JointPattern pattern = joint_pattern(type);
    pattern.discs_at = {{.centre = {7, 11, 9}, .radius = 6.0, .normal = glm::normalize(Vec3(1, 0.6, 0.8))}};
    const Clusters clusters = split(pattern, kSide, Domain::Torus, 2);
    const Disc& hand = pattern.discs_at[0];
    ASSERT_EQ(clusters.discs[0].normal, hand.normal);
    const Vec3 u = glm::normalize(glm::cross(hand.normal, Vec3(0, 0, 1)));
    const Vec3 v = glm::cross(hand.normal, u);
    int parted = 0;
    const int probes = 300;
    for (int i = 0; i < probes; ++i) {
      Rng rng(1, "probes", static_cast<std::uint64_t>(i));
      const double r = 0.9 * hand.radius * std::sqrt(rng.uniform());
      const double turn = 2.0 * kPi * rng.uniform();
      const Vec3 p = hand.centre + r * std::cos(turn) * u + r * std::sin(turn) * v;
      parted += std::none_of(clusters.list.begin(), clusters.list.end(), [&](const Cluster& cluster) {
        const Vec3 image = cluster.shape.middle() + wrapped_difference(cluster.shape.middle(), p, kSide);
        return std::all_of(cluster.shape.faces.begin(), cluster.shape.faces.end(), [&](const Polytope::Face& face) {
          return face.plane.distance(image + 1e-4 * hand.normal) < 0 && face.plane.distance(image - 1e-4 * hand.normal) < 0;
        });
      });
    }
    EXPECT_GT(parted, 0.95 * probes) << name(type);
  }
}

}  // namespace
}  // namespace outcrop

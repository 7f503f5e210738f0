#include "outcrop/render/tracer.h"

#include <cmath>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "outcrop/core/error.h"
#include "render/scenes.h"

namespace outcrop {
namespace {

constexpr double kSpread = 1e-3;

/// A ray from a random place on a sphere around `centre` towards a random place near it.
Ray random_ray(Rng& rng, const Vec3& centre, double distance, double aim) {
  const Vec3 from = centre + distance * rng.direction();
  const Vec3 to = centre + aim * rng.uniform() * rng.direction();
  return {.origin = from, .direction = glm::normalize(to - from), .spread = kSpread};
}

std::optional<double> ball_distance(const Ray& ray, const Vec3& centre, double radius) {
  const double along = glm::dot(centre - ray.origin, ray.direction);
  const double miss = glm::length(ray.origin + along * ray.direction - centre);
  if (miss >= radius) return std::nullopt;
  return along - std::sqrt(radius * radius - miss * miss);
}

/// The first sample of a dense march that lies in rock.
std::optional<double> marched_distance(const Field& field, const Ray& ray, const Box& region, double step, double end) {
  for (double t = 0.0; t < end; t += step)
    if (region.contains(ray.at(t)) && field.value(ray.at(t)) <= 0.0) return t;
  return std::nullopt;
}

TEST(Tracer, HitsABallWhereGeometrySaysNearAndFarFromTheOrigin) {
  for (const Vec3 centre : {Vec3(0.3, -0.2, 0.1), Vec3(5e6, -4e6, 3e3)}) {
    const double radius = 2.0;
    const auto ball = std::make_shared<test::Ball>(centre, radius);
    const Tracer tracer(*ball, {.region = {centre - 4.0, centre + 4.0}, .detail = 0.05, .eye = centre + Vec3(9, 0, 0)});
    RayCounters counters;
    for (std::uint64_t i = 0; i < 2'000; ++i) {
      Rng rng(7, "rays", i);
      const Ray ray = random_ray(rng, centre, 9.0, 3.0);
      const auto expected = ball_distance(ray, centre, radius);
      const double along = glm::dot(centre - ray.origin, ray.direction);
      const double miss = glm::length(ray.at(along) - centre);
      if (std::abs(miss - radius) < 2.0 * ray.width(along)) continue;  // The rim is a pixel wide.
      const auto hit = tracer.closest(ray, counters);
      ASSERT_EQ(hit.has_value(), expected.has_value()) << "ray " << i;
      ASSERT_EQ(tracer.blocked(ray, counters), hit.has_value()) << "ray " << i;
      if (!hit) continue;
      ASSERT_NEAR(hit->t, *expected, 0.1 * ray.width(hit->t)) << "ray " << i;
      ASSERT_GT(ball->value(hit->position), 0.0) << "ray " << i;
      ASSERT_LT(glm::length(hit->normal - glm::normalize(hit->position - centre)), 1e-3);
    }
  }
}

TEST(Tracer, FindsWhatADenseMarchFindsInAPileOfBlocksAndOnSteepHills) {
  const auto pile = test::block_pile({1, 2, 3}, {4, 4, 3}, 5);
  const auto hills = std::make_shared<test::Hills>(Vec3(1, 2, 3), 2.5, 1.0);
  const Box region{{-4, -3, 0}, {6, 7, 8}};
  for (const FieldPtr& field : {pile, FieldPtr(hills)}) {
    const Tracer tracer(*field, {.region = region, .detail = 0.05, .eye = {1, -12, 6}});
    RayCounters counters;
    int hits = 0, missed = 0;
    for (std::uint64_t i = 0; i < 150; ++i) {
      Rng rng(11, "rays", i);
      const Ray ray = random_ray(rng, region.centre(), 14.0, 4.0);
      const auto expected = marched_distance(*field, ray, region, 0.004, 28.0);
      const auto hit = tracer.closest(ray, counters);
      hits += expected.has_value();
      // Where the ray grazes an edge thinner than a pixel, either answer is right; elsewhere both agree.
      if (hit.has_value() != expected.has_value() || (hit && std::abs(hit->t - *expected) > 0.03)) ++missed;
      if (hit) {
        const Vec3 behind = hit->position + 0.1 * ray.width(hit->t) * ray.direction;
        ASSERT_LT(std::abs(field->value(behind)), hit->cut ? 100.0 : 0.05);
      }
    }
    EXPECT_GT(hits, 50);
    EXPECT_LE(missed, 2);
    EXPECT_EQ(counters.capped, 0u);
  }
}

TEST(Tracer, GivesTheSameHitForAnySizeOfLeaf) {
  const auto pile = test::block_pile({0, 0, 0}, {4, 4, 3}, 9);
  const Box region{{-5, -5, -4}, {5, 5, 4}};
  const TracerOptions coarse{.region = region, .detail = 10.0, .eye = {0, -12, 0}};
  const TracerOptions fine{.region = region, .detail = 0.02, .leaf_widths = 1.0, .eye = {0, -12, 0}};
  const Tracer few(*pile, coarse), many(*pile, fine);
  ASSERT_LE(few.leaf_count(), 8u);
  ASSERT_GT(many.leaf_count(), 5'000u);
  RayCounters counters;
  int different = 0;
  for (std::uint64_t i = 0; i < 2'000; ++i) {
    Rng rng(3, "rays", i);
    const Ray ray = random_ray(rng, Vec3(0.0), 12.0, 4.0);
    const auto a = few.closest(ray, counters), b = many.closest(ray, counters);
    if (a.has_value() != b.has_value() || (a && std::abs(a->t - b->t) > 0.2 * ray.width(a->t))) ++different;
  }
  EXPECT_LE(different, 4);  // Rays that graze an edge by less than a quarter of their width.
}

TEST(Tracer, CutsRockAtTheSidesOfTheRegion) {
  const auto ground = std::make_shared<test::Ground>(Vec3(0.0), Vec3(0, 0, 1));
  const Tracer tracer(*ground, {.region = {{-5, -5, -5}, {5, 5, 5}}, .detail = 0.1, .eye = {0, -20, 0}});
  RayCounters counters;
  const auto cut = tracer.closest({.origin = {1, -20, -2}, .direction = {0, 1, 0}}, counters);
  ASSERT_TRUE(cut);
  EXPECT_TRUE(cut->cut);
  EXPECT_NEAR(cut->t, 15.0, 1e-9);
  EXPECT_EQ(cut->normal, Vec3(0, -1, 0));
  EXPECT_FALSE(tracer.closest({.origin = {1, -20, 2}, .direction = {0, 1, 0}}, counters));
  const auto top = tracer.closest({.origin = {1, 1, 20}, .direction = {0, 0, -1}}, counters);
  ASSERT_TRUE(top);
  EXPECT_FALSE(top->cut);
  EXPECT_NEAR(top->t, 20.0, 1e-3);
}

/// A field whose Lipschitz bound is far too cautious.
class Cautious final : public PointField {
 public:
  [[nodiscard]] double lipschitz() const noexcept override { return 300.0; }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override { return p.z; }
};

TEST(Tracer, NeverMissesBecauseOfTheStepBound) {
  const auto field = std::make_shared<Cautious>();
  const Tracer tracer(*field, {.region = {{-20, -20, -2}, {20, 20, 2}}, .detail = 10.0, .eye = {0, 0, 10}});
  RayCounters counters;
  for (int i = 0; i < 50; ++i) {
    const Vec3 direction = glm::normalize(Vec3(0.1 * i, 0.05 * i, -1.0));
    const auto hit = tracer.closest({.origin = {0, 0, 2}, .direction = direction, .spread = 1e-4}, counters);
    ASSERT_TRUE(hit);
    ASSERT_NEAR(hit->t, -2.0 / direction.z, 1e-3);
  }
  EXPECT_GT(counters.capped, 0u);
}

TEST(Tracer, StopsAtTheEndOfTheRay) {
  const auto ball = std::make_shared<test::Ball>(Vec3(0.0), 1.0);
  const Tracer tracer(*ball, {.region = {Vec3(-2.0), Vec3(2.0)}, .detail = 0.1, .eye = {0, -5, 0}});
  RayCounters counters;
  Ray ray{.origin = {0, -5, 0}, .direction = {0, 1, 0}, .t_max = 3.9};
  EXPECT_FALSE(tracer.blocked(ray, counters));
  EXPECT_FALSE(tracer.closest(ray, counters));
  ray.t_max = 4.1;
  EXPECT_TRUE(tracer.blocked(ray, counters));
  EXPECT_TRUE(tracer.closest(ray, counters));
}

TEST(Tracer, SeesNothingWhereThereIsNoRock) {
  const auto ball = std::make_shared<test::Ball>(Vec3(100.0), 1.0);
  const Tracer tracer(*ball, {.region = {Vec3(-2.0), Vec3(2.0)}});
  RayCounters counters;
  EXPECT_EQ(tracer.leaf_count(), 0u);
  EXPECT_FALSE(tracer.closest({.origin = {0, -5, 0}, .direction = {0, 1, 0}}, counters));
}

TEST(Tracer, KeepsToItsNumberOfLeavesAndStaysRight) {
  const auto ball = std::make_shared<test::Ball>(Vec3(0.0), 2.0);
  const Box region{Vec3(-4.0), Vec3(4.0)};
  const Tracer tracer(*ball, {.region = region, .detail = 1e-3, .leaf_widths = 0.0, .max_leaves = 500});
  RayCounters counters;
  EXPECT_LE(tracer.leaf_count(), 500u);
  const auto hit = tracer.closest({.origin = {0, -5, 0}, .direction = {0, 1, 0}}, counters);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 3.0, 1e-3);
}

TEST(Tracer, RefusesARegionWithoutVolumeAndDetailOfZero) {
  const auto ball = std::make_shared<test::Ball>(Vec3(0.0), 2.0);
  EXPECT_THROW(Tracer(*ball, {.region = {Vec3(0.0), Vec3(0, 1, 1)}}), ParameterError);
  EXPECT_THROW(Tracer(*ball, {.region = {}}), ParameterError);
  EXPECT_THROW(Tracer(*ball, {.region = {Vec3(-1.0), Vec3(1.0)}, .detail = 0.0}), ParameterError);
}

}  // namespace
}  // namespace outcrop

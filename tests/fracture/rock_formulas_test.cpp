#include "outcrop/fracture/rock_formulas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "outcrop/core/rng.h"
#include "outcrop/fracture/polytope.h"

namespace outcrop {
namespace {

// Three unit normals at equal angles to each other, about the cube's diagonal.
std::array<Vec3, 3> normals_at(double angle) {
  const double sine = std::sqrt((1.0 - std::cos(angle)) / 1.5);
  std::array<Vec3, 3> normals;
  for (int i = 0; i < 3; ++i) {
    const double turn = 2.0 * kPi * i / 3.0;
    normals[static_cast<std::size_t>(i)] = {sine * std::cos(turn), sine * std::sin(turn), std::sqrt(1.0 - sine * sine)};
  }
  return normals;
}

double sine_form(const std::array<Vec3, 3>& n) {
  return 1.0 / (glm::length(glm::cross(n[0], n[1])) * glm::length(glm::cross(n[1], n[2])) *
                glm::length(glm::cross(n[2], n[0])));
}

TEST(RockFormulas, BlockVolumeIsThatOfTheParallelepiped) {
  for (Seed seed = 1; seed <= 20; ++seed) {
    Rng rng(seed, "sets");
    std::array<Vec3, 3> normals;
    std::array<double, 3> spacings;
    for (auto& n : normals) n = rng.direction();
    for (auto& s : spacings) s = rng.uniform(0.5, 2.0);
    const double det = std::abs(glm::dot(normals[0], glm::cross(normals[1], normals[2])));
    if (det < 0.1) continue;
    Polytope block = box_polytope({Vec3(-200.0), Vec3(200.0)});
    for (std::size_t i = 0; i < 3; ++i) {
      block = clipped(block, {normals[i], -0.5 * spacings[i]}, 0, 1e-9);
      block = clipped(block, {-normals[i], -0.5 * spacings[i]}, 0, 1e-9);
    }
    EXPECT_NEAR(block.volume() / block_volume(spacings, normals), 1.0, 1e-9);
  }
  const std::array<Vec3, 3> flat = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(std::sqrt(0.5), std::sqrt(0.5), 0)};
  EXPECT_EQ(block_volume({1, 1, 1}, flat), std::numeric_limits<double>::infinity());
}

TEST(RockFormulas, BlockVolumesOfObliqueSetsAreTheTabledOnesAndNotTheSineForm) {
  const struct {
    double angle_deg, exact, sine_excess;
  } rows[] = {{75, 1.0952, 0.013}, {60, 1.4142, 0.089}, {50, 1.8517, -1}, {45, 2.1974, 0.287}};
  for (const auto& row : rows) {
    const auto normals = normals_at(radians(row.angle_deg));
    const double exact = block_volume({1, 1, 1}, normals);
    EXPECT_NEAR(exact, row.exact, 6e-5) << row.angle_deg;
    if (row.sine_excess >= 0.0) {
      EXPECT_NEAR(sine_form(normals) / exact - 1.0, row.sine_excess, 6e-4) << row.angle_deg;
    }
  }
  // It is exact where two of the angles are right.
  const std::array<Vec3, 3> normals = {Vec3(1, 0, 0), Vec3(std::cos(1.0), std::sin(1.0), 0), Vec3(0, 0, 1)};
  EXPECT_NEAR(sine_form(normals), block_volume({1, 1, 1}, normals), 1e-12);
}

TEST(RockFormulas, ShapeFactorsAreTheTabledOnes) {
  const struct {
    double a2, a3, beta;
  } rows[] = {{1, 1, 27.0}, {1, 2, 31.2}, {1, 3, 38.1}, {1, 10, 92.6},
              {2, 2, 32.0}, {3, 3, 41.7}, {5, 5, 68.6}, {10, 10, 172.8}};
  for (const auto& row : rows) {
    EXPECT_NEAR(block_shape_factor({1.0, row.a2, row.a3}), row.beta, 0.06);
    EXPECT_NEAR(block_shape_factor({0.3 * row.a3, 0.3, 0.3 * row.a2}), row.beta, 0.06);  // any order, any unit
    const double jv = 1.0 + 1.0 / row.a2 + 1.0 / row.a3;
    EXPECT_NEAR(block_shape_factor({1.0, row.a2, row.a3}) / (jv * jv * jv), row.a2 * row.a3, 1e-9);
  }
}

TEST(RockFormulas, QualityFallsWithTheJointsAndStaysAPercentage) {
  EXPECT_EQ(rqd_2005(4.0), 100.0);
  EXPECT_EQ(rqd_2005(20.0), 60.0);
  EXPECT_EQ(rqd_2005(60.0), 0.0);
  EXPECT_EQ(rqd_1982(2.0), 100.0);
  EXPECT_NEAR(rqd_1982(20.0), 49.0, 1e-12);
  EXPECT_EQ(rqd_priest_hudson(0.0), 100.0);
  EXPECT_NEAR(rqd_priest_hudson(10.0), 200.0 / std::exp(1.0), 1e-12);
}

TEST(RockFormulas, ClassesBeginWhereTheTablesSay) {
  EXPECT_EQ(jv_class(0.99), "very large");
  EXPECT_EQ(jv_class(1.0), "large");
  EXPECT_EQ(jv_class(3.0), "medium");
  EXPECT_EQ(jv_class(10.0), "small");
  EXPECT_EQ(jv_class(30.0), "very small");
  EXPECT_EQ(volume_class(1e-4), "very small");
  EXPECT_EQ(volume_class(1e-3), "small");
  EXPECT_EQ(volume_class(0.1), "moderate");
  EXPECT_EQ(volume_class(1.0), "large");
  EXPECT_EQ(volume_class(10.1), "very large");
  EXPECT_EQ(shape_class(27.0), "equidimensional");
  EXPECT_EQ(shape_class(32.0), "slightly long or flat");
  EXPECT_EQ(shape_class(36.0), "moderately long or flat");
  EXPECT_EQ(shape_class(100.0), "long or flat");
  EXPECT_EQ(shape_class(300.0), "very long or flat");
}

}  // namespace
}  // namespace outcrop

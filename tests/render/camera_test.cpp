#include "outcrop/render/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "outcrop/core/error.h"
#include "render/scenes.h"

namespace outcrop {
namespace {

constexpr double kFieldOfView = 0.7, kAspect = 16.0 / 9.0;

/// The largest picture coordinate of the box's corners: 1 is the picture's edge.
double extent(const Camera& camera, const Box& box, double aspect) {
  const CameraAxes axes = camera_axes(camera);
  const double tan_v = std::tan(0.5 * camera.field_of_view);
  double result = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y, corner & 4 ? box.hi.z : box.lo.z);
    const Vec3 d = p - camera.position;
    const double depth = glm::dot(d, axes.forward);
    if (depth <= 0.0) return std::numeric_limits<double>::infinity();
    result = std::max({result, std::abs(glm::dot(d, axes.right)) / (depth * tan_v * aspect),
                       std::abs(glm::dot(d, axes.up)) / (depth * tan_v)});
  }
  return result;
}

TEST(CameraAxes, AreARightHandedFrameWithUpTowardsTheSky) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Rng rng(1, "axes", i);
    const Vec3 position = 100.0 * rng.direction();
    const CameraAxes axes = camera_axes({.position = position, .target = position + rng.direction()});
    EXPECT_NEAR(glm::length(glm::cross(axes.right, axes.up) + axes.forward), 0.0, 1e-12);
    EXPECT_GE(axes.up.z, 0.0);
    EXPECT_NEAR(axes.right.z, 0.0, 1e-12);
  }
  const CameraAxes down = camera_axes({.position = {0, 0, 5}, .target = {0, 0, 0}});
  EXPECT_NEAR(down.up.y, 1.0, 1e-12);
}

TEST(FrameBox, FillsThePictureWithTheBox) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Rng rng(2, "frame", i);
    const Vec3 centre = 1e4 * rng.direction();
    const Vec3 half(rng.uniform(0.5, 20.0), rng.uniform(0.5, 20.0), rng.uniform(0.5, 20.0));
    const Box box{centre - half, centre + half};
    const double aspect = rng.uniform(0.5, 2.5), field_of_view = rng.uniform(0.2, 1.5);
    const Camera camera = frame_box(box, rng.direction(), field_of_view, aspect);
    EXPECT_NEAR(extent(camera, box, aspect), 1.0, 1e-6);
  }
}

TEST(FrameBox, RefusesWhatItCannotFrame) {
  const Box box{Vec3(0.0), Vec3(1.0)};
  EXPECT_THROW((void)frame_box({}, {0, 1, 0}, kFieldOfView, kAspect), ParameterError);
  EXPECT_THROW((void)frame_box(box, Vec3(0.0), kFieldOfView, kAspect), ParameterError);
  EXPECT_THROW((void)frame_box(box, {0, 1, 0}, 0.0, kAspect), ParameterError);
  EXPECT_THROW((void)frame_box(box, {0, 1, 0}, kFieldOfView, 0.0), ParameterError);
}

TEST(Framed, KeepsTheWantedDirectionWhereNothingIsInTheWay) {
  const auto ball = std::make_shared<test::Ball>(Vec3(0.0), 1.0);
  const Box focus{{-1.2, -1.2, 0.2}, {1.2, 1.2, 1.2}};
  const Vec3 from(0.2, -0.5, 1.0);
  const Camera camera = framed(*ball, focus, from, kFieldOfView, kAspect);
  EXPECT_GT(glm::dot(glm::normalize(camera.position - camera.target), glm::normalize(from)), std::cos(0.3));
  EXPECT_LE(extent(camera, focus, kAspect), 1.0 / 0.45);
}

/// A straight canyon along x: floor z = 0 for |y| < 10, walls of 1:3 up to 40 m on both sides.
class Canyon final : public PointField {
 public:
  [[nodiscard]] double lipschitz() const noexcept override { return std::hypot(1.0, 3.0); }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override {
    return p.z - std::clamp(3.0 * (std::abs(p.y) - 10.0), 0.0, 40.0);
  }
};

TEST(Framed, LooksAtACanyonWallPastTheOtherOne) {
  const auto canyon = std::make_shared<Canyon>();
  const Box focus{{-20, 9, 0}, {20, 25, 41}};
  const Camera camera = framed(*canyon, focus, {0, -1, 0.1}, kFieldOfView, kAspect);
  EXPECT_GT(canyon->value(camera.position), 0.0);
  // The middle of the wall is seen.
  const Vec3 wall(0, 10.0 + 20.0 / 3.0, 20.0);
  for (int i = 0; i < 990; ++i) {
    const Vec3 p = glm::mix(camera.position, wall, i / 1000.0);
    ASSERT_GT(canyon->value(p), -1e-9) << i;
  }
}

TEST(Framed, IsNeverInsideRock) {
  for (Seed seed = 1; seed <= 20; ++seed) {
    Rng rng(seed, "framed");
    const auto hills = std::make_shared<test::Hills>(Vec3(0.0), 6.0, 5.0);
    const Vec3 centre(rng.uniform(-30.0, 30.0), rng.uniform(-30.0, 30.0), rng.uniform(-8.0, 4.0));
    const Camera camera = framed(*hills, {centre - 4.0, centre + 4.0}, rng.direction(), kFieldOfView, kAspect);
    EXPECT_GT(hills->value(camera.position), 0.0) << seed;
  }
}

TEST(Framed, RisesAboveRockThatBuriesEveryView) {
  const auto ground = std::make_shared<test::Ground>(Vec3(0, 0, 500), Vec3(0, 0, 1));
  const Camera camera = framed(*ground, {Vec3(-1.0), Vec3(1.0)}, {0, -1, 0.2}, kFieldOfView, kAspect);
  EXPECT_GT(camera.position.z, 500.0);
  EXPECT_LT(glm::length(Vec2(camera.position)), 1e-6);
}

}  // namespace
}  // namespace outcrop

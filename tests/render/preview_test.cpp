#include "outcrop/render/preview.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "render/scenes.h"

namespace outcrop {
namespace {

enum Layer { kRed, kGreen, kBlue, kAlpha, kDepth, kNormalX, kNormalY, kNormalZ, kMaterial };

constexpr int kWidth = 160, kHeight = 90;

PreviewOptions options_for(const Box& region, const Vec3& eye, const Vec3& target) {
  return {.width = kWidth,
          .height = kHeight,
          .camera = {.position = eye, .target = target},
          .region = region,
          .detail = 0.05,
          .pixel_samples = 1};
}

/// The direction through the middle of a pixel.
Vec3 pixel_direction(const PreviewOptions& options, int x, int y) {
  const CameraAxes axes = camera_axes(options.camera);
  const double tan_half = std::tan(0.5 * options.camera.field_of_view);
  const double right = (2.0 * (x + 0.5) - options.width) / options.height * tan_half;
  const double up = (1.0 - 2.0 * (y + 0.5) / options.height) * tan_half;
  return glm::normalize(axes.forward + right * axes.right + up * axes.up);
}

double pixel_spread(const PreviewOptions& options) {
  return 2.0 * std::tan(0.5 * options.camera.field_of_view) / options.height;
}

/// A pile of blocks on a slab that fills the lower part of any picture taken from above.
FieldPtr pile_on_slab(const Vec3& centre, Seed seed) {
  class Pair final : public Field {
   public:
    Pair(FieldPtr a, FieldPtr b) : a_(std::move(a)), b_(std::move(b)) {}
    void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 p = points[i];
        const double a = a_->value(p), b = b_->value(p);
        values[i] = std::min(a, b);
        if (!gradients.empty()) gradients[i] = (a < b ? a_ : b_)->gradient(p);
      }
    }
    [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }
    [[nodiscard]] FieldPtr narrow(const Box& box) const override {
      return std::make_shared<Pair>(a_->narrow(box), b_->narrow(box));
    }

   private:
    FieldPtr a_, b_;
  };
  return std::make_shared<Pair>(test::block_pile(centre, {6, 6, 2}, seed),
                                std::make_shared<test::Ground>(centre, Vec3(0, 0, 1)));
}

TEST(Preview, ShowsABallWithItsSilhouetteDepthAndNormals) {
  const Vec3 centre(1, 2, 3), eye(1, -6, 4);
  const double radius = 2.0;
  const auto ball = std::make_shared<test::Ball>(centre, radius);
  const PreviewOptions options = options_for({centre - 3.0, centre + 3.0}, eye, centre);
  const Preview preview = render_preview(*ball, options);
  ASSERT_EQ(preview.layers.channel_names,
            (std::vector<std::string>{"R", "G", "B", "A", "depth.Z", "normal.X", "normal.Y", "normal.Z",
                                      "material.ID"}));
  int inside = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 direction = pixel_direction(options, x, y);
      const double along = glm::dot(centre - eye, direction), miss = glm::length(eye + along * direction - centre);
      if (std::abs(miss - radius) < pixel_spread(options) * along) continue;
      const bool hit = miss < radius;
      ASSERT_EQ(preview.layers.at(x, y, kAlpha), hit ? 1.0f : 0.0f) << x << ' ' << y;
      const double depth = hit ? along - std::sqrt(radius * radius - miss * miss) : 0.0;
      ASSERT_NEAR(preview.layers.at(x, y, kDepth), depth, 1e-3);
      if (!hit) continue;
      ++inside;
      const Vec3 normal = (eye + depth * direction - centre) / radius;
      ASSERT_NEAR(preview.layers.at(x, y, kNormalX), normal.x, 1e-2);
      ASSERT_NEAR(preview.layers.at(x, y, kNormalY), normal.y, 1e-2);
      ASSERT_NEAR(preview.layers.at(x, y, kNormalZ), normal.z, 1e-2);
    }
  EXPECT_GT(inside, 1'000);
}

TEST(Preview, HasNoHolesInClosedRock) {
  for (Seed seed = 1; seed <= 6; ++seed) {
    Rng rng(seed, "view");
    const double azimuth = rng.uniform(0.0, 2.0 * kPi), elevation = rng.uniform(0.5, 1.2);
    const Vec3 from(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                    std::sin(elevation));
    const auto field = pile_on_slab(Vec3(0.0), seed);
    PreviewOptions options = options_for({{-60, -60, -2}, {60, 60, 5}}, 20.0 * from, Vec3(0.0));
    options.camera.field_of_view = 0.5;
    options.occlusion_samples = 0;
    const Preview preview = render_preview(*field, options);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        ASSERT_EQ(preview.layers.at(x, y, kAlpha), 1.0f) << seed << ": " << x << ' ' << y;
  }
}

TEST(Preview, ShowsNoAcneOnAPlane) {
  for (const Vec3 normal : {Vec3(0, 0, 1), Vec3(0.3, -0.5, 0.8)})
    for (const Vec3 at : {Vec3(0.0), Vec3(5e6, 4e6, 100)}) {
      const auto plane = std::make_shared<test::Ground>(at, normal);
      PreviewOptions options = options_for({at - 40.0, at + 40.0}, at + Vec3(1, -8, 6), at);
      options.camera.field_of_view = 0.6;
      options.sun = {-0.9, -0.3, 0.25};  // Low: shadow rays nearly graze the plane.
      options.occlusion_samples = 0;
      const Preview sunny = render_preview(*plane, options);
      const float red = sunny.layers.at(kWidth / 2, kHeight / 2, kRed);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) ASSERT_NEAR(sunny.layers.at(x, y, kRed), red, 1e-4f * red) << x << ' ' << y;
      options.occlusion_samples = 16;
      const Preview shaded = render_preview(*plane, options);
      const float green = shaded.layers.at(kWidth / 2, kHeight / 2, kGreen);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          ASSERT_NEAR(shaded.layers.at(x, y, kGreen), green, 0.06f * green) << x << ' ' << y;
    }
}

/// A ball above a plane.
class BallOverGround final : public PointField {
 public:
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }
  static constexpr double kRadius = 1.0;
  static constexpr double kBallHeight = 2.5;

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override {
    return std::min(p.z, glm::length(p - Vec3(0, 0, kBallHeight)) - kRadius);
  }
};

TEST(Preview, CastsTheShadowOfABallWhereGeometrySays) {
  const auto field = std::make_shared<BallOverGround>();
  PreviewOptions options = options_for({{-20, -20, -1}, {20, 20, 4}}, {1, -11, 7}, {1, 1, 0});
  options.sun = {-0.5, -0.4, 0.75};
  options.occlusion_samples = 0;
  const Preview preview = render_preview(*field, options);
  const Vec3 sun = glm::normalize(options.sun), ball(0, 0, BallOverGround::kBallHeight);
  const float lit = preview.layers.at(0, kHeight - 1, kRed);  // A corner of the picture, far from the shadow.
  int shaded = 0, sunny = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 p = options.camera.position + double(preview.layers.at(x, y, kDepth)) * pixel_direction(options, x, y);
      if (preview.layers.at(x, y, kAlpha) != 1.0f || std::abs(p.z) > 0.05) continue;  // The plane only.
      const double miss = glm::length(glm::cross(ball - p, sun));
      const float red = preview.layers.at(x, y, kRed);
      if (miss > 1.05) {
        ++sunny;
        ASSERT_NEAR(red, lit, 1e-3f * lit) << x << ' ' << y;
      } else if (miss < 0.95) {
        ++shaded;
        ASSERT_LT(red, 0.5f * lit) << x << ' ' << y;
      }
    }
  EXPECT_GT(sunny, 1'000);
  EXPECT_GT(shaded, 50);
}

TEST(Preview, DarkensCorners) {
  class Corner final : public PointField {  // A floor that meets a wall at y = 0.
   public:
    [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }

   protected:
    [[nodiscard]] double at(const Vec3& p) const noexcept override { return std::min(p.z, -p.y); }
  };
  PreviewOptions options = options_for({{-20, -20, -1}, {20, 1, 12}}, {0, -9, 8}, {0, -3, 0});
  options.sun = {0, 1, 0.3};  // Behind the wall: only the sky lights the floor.
  options.occlusion_samples = 32;
  const Preview preview = render_preview(*std::make_shared<Corner>(), options);
  double near = 0.0, far = 0.0;
  int near_count = 0, far_count = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (preview.layers.at(x, y, kNormalZ) < 0.99f) continue;
      const Vec3 p = options.camera.position + double(preview.layers.at(x, y, kDepth)) * pixel_direction(options, x, y);
      if (p.y > -0.5) near += preview.layers.at(x, y, kGreen), ++near_count;
      if (p.y < -5.0) far += preview.layers.at(x, y, kGreen), ++far_count;
    }
  ASSERT_GT(near_count, 100);
  ASSERT_GT(far_count, 100);
  // At the foot of a wall half of the sky is hidden; the wall gives back some light.
  EXPECT_LT(near / near_count, 0.8 * far / far_count);
  EXPECT_GT(near / near_count, 0.4 * far / far_count);
}

TEST(Preview, IsTheSamePictureWhenTheWorldIsMovedFarAway) {
  const Vec3 far(5e6, -5e6, 5e3);
  PreviewOptions options = options_for({{-10, -10, -2}, {10, 10, 5}}, {4, -14, 9}, {0, 0, 0});
  const Preview here = render_preview(*pile_on_slab(Vec3(0.0), 4), options);
  options.region = options.region.moved(far);
  options.camera.position += far;
  options.camera.target += far;
  const Preview there = render_preview(*pile_on_slab(far, 4), options);
  int different = 0;
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      // Twice what hits are found to; more only where a pixel's ray grazes an edge.
      const float depth = here.layers.at(x, y, kDepth);
      different += std::abs(depth - there.layers.at(x, y, kDepth)) > 2e-4f * depth;
      for (int c = 0; c < 3; ++c) sum += std::abs(here.beauty.at(x, y, c) - there.beauty.at(x, y, c));
    }
  EXPECT_LE(different, kWidth * kHeight / 1'000);
  EXPECT_LT(sum / (3.0 * kWidth * kHeight), 1e-3);
}

TEST(Preview, HasTheSameBytesForOneThreadAndForTwo) {
  const auto field = pile_on_slab(Vec3(0.0), 2);
  PreviewOptions options = options_for({{-10, -10, -2}, {10, 10, 5}}, {4, -14, 9}, {0, 0, 0});
  options.pixel_samples = 4;
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return render_preview(*field, options);
  };
  const Preview one = with_threads(1), two = with_threads(2);
  EXPECT_EQ(one.beauty.pixels, two.beauty.pixels);
  EXPECT_EQ(one.layers.pixels, two.layers.pixels);
  EXPECT_EQ(one.statistics.steps, two.statistics.steps);
  options.seed = 2;
  EXPECT_NE(one.beauty.pixels, render_preview(*field, options).beauty.pixels);
}

TEST(Preview, ColoursByLabelAndNamesIt) {
  const auto pile = test::block_pile(Vec3(0.0), {3, 3, 2}, 1);
  PreviewOptions options = options_for({Vec3(-6.0), Vec3(6.0)}, {4, -14, 9}, Vec3(0.0));
  options.colours = {{0.8f, 0.0f, 0.0f}, {0.0f, 0.8f, 0.0f}, {0.0f, 0.0f, 0.8f}};
  const Preview preview = render_preview(*pile, options);
  int seen[3] = {};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (preview.layers.at(x, y, kAlpha) < 1.0f) continue;
      const int label = static_cast<int>(preview.layers.at(x, y, kMaterial));
      ASSERT_TRUE(label >= 0 && label < 3);
      ++seen[label];
      for (int c = 0; c < 3; ++c) ASSERT_EQ(preview.layers.at(x, y, c) > 0.0f, c == label);
    }
  for (const int count : seen) EXPECT_GT(count, 100);
}

void expect_error(const Field& field, const PreviewOptions& options, const std::string& text) {
  try {
    (void)render_preview(field, options);
    FAIL() << "expected: " << text;
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

TEST(Preview, SaysWhatIsWrongWithItsOptions) {
  const auto ground = std::make_shared<test::Ground>(Vec3(0.0), Vec3(0, 0, 1));
  const PreviewOptions good = options_for({Vec3(-9.0), Vec3(9.0)}, {0, -8, 3}, Vec3(0.0));
  PreviewOptions bad = good;
  bad.camera.position = {0, 0, -3.2};
  expect_error(*ground, bad, "camera.position: expected a place in the air, got 3.2 m inside rock");
  bad = good, bad.camera.target = bad.camera.position;
  expect_error(*ground, bad, "camera.target");
  bad = good, bad.camera.field_of_view = 0.0;
  expect_error(*ground, bad, "camera.field_of_view");
  bad = good, bad.width = 0;
  expect_error(*ground, bad, "width");
  bad = good, bad.height = 16385;
  expect_error(*ground, bad, "height");
  bad = good, bad.pixel_samples = 0;
  expect_error(*ground, bad, "pixel_samples");
  bad = good, bad.occlusion_samples = -1;
  expect_error(*ground, bad, "occlusion_samples");
  bad = good, bad.sun = Vec3(0.0);
  expect_error(*ground, bad, "sun");
  bad = good, bad.region = {};
  expect_error(*ground, bad, "region");
  bad = good, bad.detail = -1.0;
  expect_error(*ground, bad, "detail");
}

TEST(Preview, StopsWhenAsked) {
  const auto ground = std::make_shared<test::Ground>(Vec3(0.0), Vec3(0, 0, 1));
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW((void)render_preview(*ground, options_for({Vec3(-9.0), Vec3(9.0)}, {0, -8, 3}, Vec3(0.0)),
                                    Task{.stop = source.get_token()}),
               Cancelled);
}

}  // namespace
}  // namespace outcrop

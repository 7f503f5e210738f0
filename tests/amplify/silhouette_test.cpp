// The preview and the mesh of one field show the same outline.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "outcrop/amplify/amplify.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/render/camera.h"
#include "outcrop/render/preview.h"
#include "terraces.h"

namespace outcrop {
namespace {

constexpr int kWidth = 200, kHeight = 140;

/// Pixels whose centres a triangle of the mesh covers; the mesh lies wholly in front of the camera.
std::vector<char> covered_pixels(const TriangleMesh& mesh, const Camera& camera) {
  const CameraAxes axes = camera_axes(camera);
  const double scale = 0.5 * kHeight / std::tan(0.5 * camera.field_of_view);
  std::vector<Vec2> screen;
  for (const Vec3f& position : mesh.positions) {
    const Vec3 d = mesh.origin + Vec3(position) - camera.position;
    const double depth = glm::dot(d, axes.forward);
    screen.emplace_back(0.5 * kWidth + scale * glm::dot(d, axes.right) / depth,
                        0.5 * kHeight - scale * glm::dot(d, axes.up) / depth);
  }
  std::vector<char> covered(static_cast<std::size_t>(kWidth) * kHeight, 0);
  for (const auto& t : mesh.triangles) {
    const Vec2 a = screen[t[0]], b = screen[t[1]], c = screen[t[2]];
    const Vec2 lo = glm::min(a, glm::min(b, c)), hi = glm::max(a, glm::max(b, c));
    const auto side = [](const Vec2& p, const Vec2& q, const Vec2& r) { return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x); };
    for (int y = std::max(0, static_cast<int>(lo.y - 0.5)); y < std::min<double>(kHeight, hi.y + 0.5); ++y)
      for (int x = std::max(0, static_cast<int>(lo.x - 0.5)); x < std::min<double>(kWidth, hi.x + 0.5); ++x) {
        const Vec2 p(x + 0.5, y + 0.5);
        const double u = side(a, b, p), v = side(b, c, p), w = side(c, a, p);
        if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) covered[static_cast<std::size_t>(y) * kWidth + x] = 1;
      }
  }
  return covered;
}

TEST(Silhouette, OfThePreviewIsThatOfTheMesh) {
  const Heightfield heightfield = test::terraces();
  StrataFile strata;
  strata.materials[0].tile_side = 10.0;
  strata.materials[0].sample_spacing = 0.6;
  const double cell = 0.2;
  const Amplified rock = amplify(heightfield, strata, {.region_lo = {4, 4}, .region_hi = {60, 60}, .resolution = cell});
  const TriangleMesh mesh =
      polygonize(*rock.field, {.region = rock.region, .resolution = cell, .border = Border::Closed, .parts = Parts::Grounded}).mesh;
  const Camera camera{.position = {-60.0, 5.0, 45.0}, .target = {32.0, 32.0, 8.0}, .field_of_view = 0.75};
  const Preview preview = render_preview(
      *rock.field, {.width = kWidth, .height = kHeight, .camera = camera, .region = rock.region, .detail = cell,
                    .occlusion_samples = 0, .pixel_samples = 1});
  const std::vector<char> covered = covered_pixels(mesh, camera);
  const auto names = preview.layers.channel_names;
  const int alpha = static_cast<int>(std::ranges::find(names, "A") - names.begin());
  int rock_pixels = 0, outliers = 0;
  for (int y = 1; y + 1 < kHeight; ++y)
    for (int x = 1; x + 1 < kWidth; ++x) {
      rock_pixels += covered[static_cast<std::size_t>(y) * kWidth + x];
      // On the outline the mesh may be off by its tolerance: there the neighbours disagree among themselves.
      bool uniform = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          uniform = uniform && covered[static_cast<std::size_t>(y + dy) * kWidth + x + dx] == covered[static_cast<std::size_t>(y) * kWidth + x];
      if (uniform) outliers += (preview.layers.at(x, y, alpha) > 0.5f) != (covered[static_cast<std::size_t>(y) * kWidth + x] != 0);
    }
  EXPECT_GT(rock_pixels, kWidth * kHeight / 5);
  EXPECT_LT(rock_pixels, kWidth * kHeight * 9 / 10);
  EXPECT_LE(outliers, rock_pixels / 1000) << "of " << rock_pixels;
}

}  // namespace
}  // namespace outcrop

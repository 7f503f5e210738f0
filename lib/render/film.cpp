#include "film.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "outcrop/core/parallel.h"
#include "sky.h"

namespace outcrop::render {
namespace {

constexpr int kRadius = 2;              // Pixels of the ambient filter.
constexpr double kPlaneWidths = 1.0;    // Pixel widths off the tangent plane at which a neighbour's weight is 1/e.
constexpr int kNormalSharpness = 8;     // Power of the cosine between normals, as a power of two: 2^3.

double weight(const Pixel& centre, const Pixel& other, double width) {
  const double off_plane = glm::dot(other.position - centre.position, centre.normal) / (kPlaneWidths * width);
  double agreement = std::max(0.0, glm::dot(centre.normal, other.normal));
  for (int power = 1; power < kNormalSharpness; power *= 2) agreement *= agreement;
  return other.coverage * agreement * std::exp(-off_plane * off_plane);
}

}  // namespace

std::vector<Vec3f> smooth_ambient(const Film& film, const Task& task) {
  std::vector<Vec3f> smooth(film.pixels.size(), Vec3f(0.0f));
  parallel_for(
      static_cast<std::size_t>(film.height),
      [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < film.width; ++x) {
          const std::size_t index = row * film.width + x;
          const Pixel& centre = film.pixels[index];
          if (centre.coverage <= 0.0f) continue;
          const double width = std::max(film.spread * centre.depth, 1e-12);
          Vec3 sum(0.0);
          double total = 0.0;
          for (int v = std::max(0, y - kRadius); v <= std::min(film.height - 1, y + kRadius); ++v)
            for (int u = std::max(0, x - kRadius); u <= std::min(film.width - 1, x + kRadius); ++u) {
              const Pixel& other = film.pixels[static_cast<std::size_t>(v) * film.width + u];
              if (other.coverage <= 0.0f) continue;
              const double w = weight(centre, other, width);
              sum += w * Vec3(other.ambient);
              total += w;
            }
          smooth[index] = total > 0.0 ? Vec3f(sum / total) : centre.ambient;
        }
      },
      Task{.stop = task.stop});
  return smooth;
}

Preview develop(const Film& film, const Task& task) {
  const std::vector<Vec3f> ambient = smooth_ambient(film, task);
  Preview preview;
  preview.beauty = {.width = film.width, .height = film.height, .channels = 3, .channel_names = {"R", "G", "B"}};
  preview.layers = {.width = film.width,
                    .height = film.height,
                    .channels = 9,
                    .channel_names = {"R", "G", "B", "A", "depth.Z", "normal.X", "normal.Y", "normal.Z",
                                      "material.ID"}};
  preview.beauty.pixels.resize(film.pixels.size() * 3);
  preview.layers.pixels.resize(film.pixels.size() * 9);
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const Pixel& pixel = film.pixels[i];
    const Vec3f linear = pixel.background + pixel.sunlit + pixel.coverage * pixel.albedo * ambient[i];
    const Vec3f shown = display_colour(linear);
    std::copy_n(&shown.x, 3, &preview.beauty.pixels[3 * i]);
    const Vec3f normal(pixel.normal);
    const float layers[9] = {linear.x, linear.y, linear.z, pixel.coverage, pixel.depth, normal.x, normal.y, normal.z,
                             static_cast<float>(pixel.label)};
    std::copy_n(layers, 9, &preview.layers.pixels[9 * i]);
  }
  return preview;
}

}  // namespace outcrop::render

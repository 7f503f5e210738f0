#include "outcrop/render/preview.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdint>
#include <optional>
#include <vector>

#include "film.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "outcrop/render/tracer.h"
#include "sky.h"

namespace outcrop {
namespace {

using render::Film;
using render::Pixel;

constexpr int kTile = 16;                  // Pixels a side of what one thread does at a time.
constexpr int kLargestImage = 16384;       // Pixels a side.
constexpr double kLift = 0.5;              // Pixel widths that secondary rays start above the surface.
constexpr double kShadowSpread = 1e-3;     // The sun's disc is 9e-3 wide: finer things cast no shadow.
constexpr double kAmbientWidth = 2.0;      // Pixel widths of a sky ray where it starts.
constexpr double kAmbientSpread = 0.2;     // Sky rays stand for wide cones.
constexpr double kAmbientReach = 0.3;      // Of the region's diagonal: rock farther away is taken for sky.
const Vec3f kNoColour{0.42f, 0.40f, 0.37f};  // Of labels without a colour.
const Vec3f kCutColour{0.27f, 0.23f, 0.19f};

/// One task's view of the scene.
struct View {
  const PreviewOptions& options;
  const Tracer& tracer;
  CameraAxes axes;
  Vec3 sun;
  double tan_half = 0.0;  // Of the vertical field of view.
  double spread = 0.0;
  double ambient_reach = 0.0;

  [[nodiscard]] Vec3 direction(double x, double y) const {
    const double right = (2.0 * x - options.width) / options.height * tan_half;
    const double up = (1.0 - 2.0 * y / options.height) * tan_half;
    return glm::normalize(axes.forward + right * axes.right + up * axes.up);
  }
};

/// Where ray k of a pixel goes through it: the centre first, then the R2 sequence (Roberts 2018).
Vec2 sample_position(int k) {
  constexpr double kPlastic = 1.32471795724474602596;
  const double x = 0.5 + k / kPlastic, y = 0.5 + k / (kPlastic * kPlastic);
  return {x - std::floor(x), y - std::floor(y)};
}

Vec3f albedo_of(const RayHit& hit, const PreviewOptions& options) {
  if (hit.cut) return kCutColour;
  return hit.label < options.colours.size() ? options.colours[hit.label] : kNoColour;
}

/// Light of the sun that a white surface would reflect.
Vec3f sunlight(const View& view, const RayHit& hit, double width, RayCounters& counters) {
  const double cosine = glm::dot(hit.normal, view.sun);
  if (cosine <= 0.0) return Vec3f(0.0f);
  const Ray shadow{.origin = hit.position + kLift * width * hit.normal,
                   .direction = view.sun,
                   .base_width = width,
                   .spread = kShadowSpread};
  if (view.tracer.blocked(shadow, counters)) return Vec3f(0.0f);
  return static_cast<float>(cosine) * render::sun_on_white();
}

/// Mean light along every `samples`-th of the pixel's sky rays, from the k-th on; without sky rays, an open sky's.
Vec3f skylight(const View& view, const RayHit& hit, double width, int k, const Vec2& shift, RayCounters& counters) {
  const int samples = view.options.pixel_samples;
  const int count = (view.options.occlusion_samples + samples - 1) / samples;
  if (count == 0) return render::sky_radiance(hit.normal, view.sun);
  Vec3f sum(0.0f);
  for (int i = 0; i < count; ++i) {
    const Ray ray{.origin = hit.position + kLift * width * hit.normal,
                  .direction = render::cosine_direction(hit.normal, k + i * samples, count * samples, shift),
                  .t_max = view.ambient_reach,
                  .base_width = kAmbientWidth * width,
                  .spread = kAmbientSpread};
    sum += view.tracer.blocked(ray, counters) ? render::rock_radiance(view.sun)
                                              : render::sky_radiance(ray.direction, view.sun);
  }
  return sum / static_cast<float>(count);
}

Pixel trace_pixel(const View& view, int x, int y, RayCounters& counters) {
  const PreviewOptions& options = view.options;
  Rng rng(options.seed, "pixel", static_cast<std::uint64_t>(y) * options.width + x);
  const double shift_x = rng.uniform(), shift_y = rng.uniform();
  const int samples = options.pixel_samples;
  Pixel pixel;
  int hits = 0;
  for (int k = 0; k < samples; ++k) {
    const Vec2 at = sample_position(k);
    const Ray ray{.origin = options.camera.position,
                  .direction = view.direction(x + at.x, y + at.y),
                  .spread = view.spread};
    const std::optional<RayHit> hit = view.tracer.closest(ray, counters);
    if (!hit) {
      pixel.background += render::backdrop(ray.direction);
      continue;
    }
    const double width = ray.width(hit->t);
    const Vec3f albedo = albedo_of(*hit, options);
    pixel.sunlit += albedo * sunlight(view, *hit, width, counters);
    pixel.albedo += albedo;
    // The rays of one pixel share one set of directions between them.
    pixel.ambient += skylight(view, *hit, width, k, {shift_x, shift_y}, counters);
    if (hits++ > 0) continue;
    pixel.depth = static_cast<float>(hit->t);
    pixel.position = hit->position;
    pixel.normal = hit->normal;
    pixel.label = hit->label;
  }
  pixel.coverage = static_cast<float>(hits) / samples;
  pixel.sunlit /= static_cast<float>(samples);
  pixel.background /= static_cast<float>(samples);
  if (hits > 0) pixel.albedo /= static_cast<float>(hits), pixel.ambient /= static_cast<float>(hits);
  return pixel;
}

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check(const Field& field, const PreviewOptions& options) {
  require(options.width >= 1 && options.width <= kLargestImage, "width", "1 ... 16384 pixels", options.width);
  require(options.height >= 1 && options.height <= kLargestImage, "height", "1 ... 16384 pixels", options.height);
  require(options.occlusion_samples >= 0, "occlusion_samples", ">= 0", options.occlusion_samples);
  require(options.pixel_samples >= 1, "pixel_samples", ">= 1", options.pixel_samples);
  require(finite(options.sun) && glm::length(options.sun) > 0.0, "sun", "a finite vector that is not zero", "another");
  const Vec3& eye = options.camera.position;
  if (!options.region.contains(eye)) return;
  const double value = field.value(eye);
  if (value > 0.0) return;
  const double slope = glm::length(field.gradient(eye));
  char got[64];
  std::snprintf(got, sizeof got, "%.3g m inside rock", -value / std::max(slope, 1e-6));
  require(false, "camera.position", "a place in the air", got);
}

View view_of(const PreviewOptions& options, const CameraAxes& axes, const Tracer& tracer) {
  View view{.options = options, .tracer = tracer, .axes = axes, .sun = glm::normalize(options.sun)};
  view.tan_half = std::tan(0.5 * options.camera.field_of_view);
  view.spread = 2.0 * view.tan_half / options.height;
  view.ambient_reach = kAmbientReach * 2.0 * options.region.half_diagonal();
  return view;
}

TracerOptions tracer_options(const PreviewOptions& options, const CameraAxes& axes) {
  const double tan_v = std::tan(0.5 * options.camera.field_of_view), aspect = double(options.width) / options.height;
  return {.region = options.region,
          .detail = options.detail,
          .eye = options.camera.position,
          .spread = 2.0 * tan_v / options.height,
          .view = axes.forward,
          .view_angle = std::atan(tan_v * std::hypot(1.0, aspect))};
}

}  // namespace

Preview render_preview(const Field& field, const PreviewOptions& options, const Task& task) {
  const CameraAxes axes = camera_axes(options.camera);
  check(field, options);
  const Tracer tracer(field, tracer_options(options, axes), task);
  const View view = view_of(options, axes, tracer);

  Film film{.width = options.width, .height = options.height, .spread = view.spread};
  film.pixels.resize(static_cast<std::size_t>(options.width) * options.height);
  const int tiles_x = (options.width + kTile - 1) / kTile, tiles_y = (options.height + kTile - 1) / kTile;
  const std::size_t tiles = static_cast<std::size_t>(tiles_x) * tiles_y;
  std::vector<RayCounters> counters(tiles);
  task.begin("preview", tiles);
  parallel_for(
      tiles,
      [&](std::size_t tile) {
        const int x0 = static_cast<int>(tile % tiles_x) * kTile, y0 = static_cast<int>(tile / tiles_x) * kTile;
        for (int y = y0; y < std::min(y0 + kTile, options.height); ++y)
          for (int x = x0; x < std::min(x0 + kTile, options.width); ++x)
            film.pixels[static_cast<std::size_t>(y) * options.width + x] = trace_pixel(view, x, y, counters[tile]);
        task.advance();
      },
      task);

  Preview preview = render::develop(film, task);
  preview.statistics.leaves = tracer.leaf_count();
  for (const RayCounters& tile : counters) {
    preview.statistics.rays += tile.rays;
    preview.statistics.steps += tile.steps;
    preview.statistics.capped_rays += tile.capped;
  }
  return preview;
}

}  // namespace outcrop

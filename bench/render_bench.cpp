/// Rays per second against a pile of rounded blocks, and seconds to make a tracer; `items_per_second` are rays.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/implicit/rounded_polytope.h"
#include "outcrop/render/camera.h"
#include "outcrop/render/preview.h"
#include "outcrop/render/tracer.h"

namespace outcrop {
namespace {

constexpr int kImage = 512;        // Pixels a side.
constexpr double kSide = 25.6;     // Metres of the cube that the blocks fill.
constexpr int kBlocksASide = 5;
constexpr int kPlanes = 20;
constexpr double kRounding = 0.25;

/// 125 blocks of 20 planes on a jittered lattice: the model of the measurements in docs, drawn anew.
FieldPtr pile(const Warp& warp = {}) {
  const double cell = kSide / kBlocksASide;
  std::vector<FieldPtr> blocks;
  for (int i = 0; i < kBlocksASide * kBlocksASide * kBlocksASide; ++i) {
    Rng rng(1, "bench pile", static_cast<std::uint64_t>(i));
    const Vec3 lattice(i % kBlocksASide, i / kBlocksASide % kBlocksASide, i / (kBlocksASide * kBlocksASide));
    const Vec3 centre = cell * (lattice + 0.5 - 0.5 * kBlocksASide) + 0.2 * cell * rng.direction();
    std::vector<Plane> planes;
    for (int k = 0; k < kPlanes; ++k) {
      const Vec3 normal = rng.direction();
      const double distance = cell * rng.uniform(0.4, 0.6);
      planes.push_back({normal, -glm::dot(normal, centre) - distance});
    }
    blocks.push_back(std::make_shared<RoundedPolytope>(planes, centre, kRounding, warp));
  }
  return union_of(std::move(blocks));
}

Camera camera() { return frame_box({Vec3(-0.5 * kSide), Vec3(0.5 * kSide)}, {0.4, 1.0, -0.5}, 0.7, 1.0); }

TracerOptions tracer_options(double detail) {
  const Camera eye = camera();
  return {.region = Box{Vec3(-0.5 * kSide), Vec3(0.5 * kSide)}.grown(4.0),
          .detail = detail,
          .eye = eye.position,
          .spread = 2.0 * std::tan(0.5 * eye.field_of_view) / kImage,
          .view = camera_axes(eye).forward,
          .view_angle = 0.6};
}

void make_tracer(benchmark::State& state) {
  const FieldPtr field = pile();
  std::size_t leaves = 0;
  for (auto _ : state) leaves = Tracer(*field, tracer_options(0.01 * state.range(0))).leaf_count();
  state.counters["leaves"] = static_cast<double>(leaves);
}
BENCHMARK(make_tracer)->ArgName("detail_cm")->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

/// A relief 10 cm deep, of features a few decimetres wide.
Warp rough_warp() {
  Image image{.width = 512, .height = 512, .channels = 1};
  image.pixels.resize(512 * 512);
  Rng rng(1, "bench relief");
  for (float& pixel : image.pixels) pixel = static_cast<float>(rng.uniform());
  return {std::make_shared<const Relief>(Relief(image, 4.0).smoothed(0.1)), 0.1};
}

/// One thread: rays per second of CPU time. Arguments: detail, warp.
void primary_rays(benchmark::State& state) {
  const FieldPtr field = pile(state.range(1) ? rough_warp() : Warp{});
  const TracerOptions options = tracer_options(0.01 * state.range(0));
  const Tracer tracer(*field, options);
  const Camera eye = camera();
  const CameraAxes axes = camera_axes(eye);
  const double tan_half = std::tan(0.5 * eye.field_of_view);
  RayCounters counters;
  for (auto _ : state)
    for (int y = 0; y < kImage; ++y)
      for (int x = 0; x < kImage; ++x) {
        const double right = (2.0 * (x + 0.5) / kImage - 1.0) * tan_half;
        const double up = (1.0 - 2.0 * (y + 0.5) / kImage) * tan_half;
        const Ray ray{.origin = eye.position,
                      .direction = glm::normalize(axes.forward + right * axes.right + up * axes.up),
                      .spread = options.spread};
        benchmark::DoNotOptimize(tracer.closest(ray, counters));
      }
  state.SetItemsProcessed(static_cast<std::int64_t>(counters.rays));
  state.counters["values_a_ray"] = static_cast<double>(counters.steps) / static_cast<double>(counters.rays);
}
BENCHMARK(primary_rays)
    ->ArgNames({"detail_cm", "warp"})
    ->ArgsProduct({{5, 20, 80}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

/// The whole picture as programs make it, on all threads.
void preview(benchmark::State& state) {
  const FieldPtr field = pile();
  const PreviewOptions options{
      .width = 640, .height = 360, .camera = camera(), .region = tracer_options(1.0).region, .detail = 0.1};
  std::size_t rays = 0;
  for (auto _ : state) rays += render_preview(*field, options).statistics.rays;
  state.SetItemsProcessed(static_cast<std::int64_t>(rays));
}
BENCHMARK(preview)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

}  // namespace
}  // namespace outcrop

/// Triangles per second of the mesher, with roots and normals: uniform and adaptive cells, on fields that cost next to
/// nothing and on a fractured tile.
///
/// Counters: `triangles`; `triangles/s` by the processor time of all threads; `error_mean` and `error_rms`, in finest
/// cells, of points on the triangles; `fewer`: triangles of uniform cells over those of adaptive ones.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "outcrop/core/parallel.h"
#include "outcrop/core/rng.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/implicit/rounded_polytope.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"

namespace {

using outcrop::Border;
using outcrop::FieldPtr;
using outcrop::Parts;
using outcrop::Points;
using outcrop::PolygonizeOptions;
using outcrop::Vec3;

/// The exact distance to a unit ball, in batches.
class Ball final : public outcrop::Field {
 public:
  void values(const Points& p, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t i = 0; i < p.size(); ++i)
      values[i] = std::sqrt(p.x[i] * p.x[i] + p.y[i] * p.y[i] + p.z[i] * p.z[i]) - 1.0;
    for (std::size_t i = 0; i < gradients.size(); ++i) gradients[i] = p[i] / (values[i] + 1.0);
  }
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }
};

/// Rolling ground: a surface that reaches the region's walls.
class Hills final : public outcrop::Field {
 public:
  void values(const Points& p, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t i = 0; i < p.size(); ++i)
      values[i] = p.z[i] - 0.1 * std::sin(3.0 * p.x[i]) * std::sin(4.0 * p.y[i]);
    for (std::size_t i = 0; i < gradients.size(); ++i)
      gradients[i] = {-0.3 * std::cos(3.0 * p.x[i]) * std::sin(4.0 * p.y[i]),
                      -0.4 * std::sin(3.0 * p.x[i]) * std::cos(4.0 * p.y[i]), 1.0};
  }
  [[nodiscard]] double lipschitz() const noexcept override { return 1.2; }
};

void report(benchmark::State& state, std::size_t triangles) {
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(triangles * state.iterations()), benchmark::Counter::kIsRate);
}

template <class F>
void mesh(benchmark::State& state, Border border, Parts parts) {
  const outcrop::ThreadLimit limit(static_cast<int>(state.range(1)));
  const auto field = std::make_shared<F>();
  const PolygonizeOptions options{.region = {Vec3(-1.1), Vec3(1.1)},
                                  .resolution = 2.2 / static_cast<double>(state.range(0)),
                                  .border = border,
                                  .parts = parts,
                                  .keep_voids = border == Border::Open && parts == Parts::All};
  std::size_t triangles = 0;
  for (auto _ : state) triangles = outcrop::polygonize(*field, options).mesh.triangles.size();
  report(state, triangles);
}

void check(benchmark::State& state) {
  const auto found =
      outcrop::polygonize(*std::make_shared<Ball>(), {.region = {Vec3(-1.1), Vec3(1.1)}, .resolution = 0.01});
  for (auto _ : state) benchmark::DoNotOptimize(outcrop::check_mesh(found.mesh).closed());
  report(state, found.mesh.triangles.size());
}

void estimate(benchmark::State& state) {
  const auto field = std::make_shared<Ball>();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        outcrop::estimate_polygonize(*field, {.region = {Vec3(-1.1), Vec3(1.1)}, .resolution = 0.0025}));
}

void ball(benchmark::State& state, Border border, Parts parts) { mesh<Ball>(state, border, parts); }
void hills(benchmark::State& state, Border border, Parts parts) { mesh<Hills>(state, border, parts); }

constexpr double kTileSide = 20.0;

/// A relief of white noise, smoothed, that carves up to 10 cm.
outcrop::Warp rough_warp() {
  outcrop::Image image{.width = 512, .height = 512, .channels = 1};
  image.pixels.resize(512 * 512);
  outcrop::Rng rng(1, "bench relief");
  for (float& pixel : image.pixels) pixel = static_cast<float>(rng.uniform());
  return {std::make_shared<const outcrop::Relief>(outcrop::Relief(image, 4.0).smoothed(0.1)), 0.1};
}

/// 125 rounded blocks of 20 planes around jittered places in a cube of 20 m, from (0, 0, 0).
const FieldPtr& tile(bool warp) {
  static const std::array<FieldPtr, 2> tiles = [] {
    std::array<FieldPtr, 2> made;
    const outcrop::Warp relief = rough_warp();
    for (int with_warp = 0; with_warp < 2; ++with_warp) {
      std::vector<FieldPtr> blocks;
      for (int i = 0; i < 125; ++i) {
        outcrop::Rng rng(1, "bench block", i);
        Vec3 jitter;
        for (int axis = 0; axis < 3; ++axis) jitter[axis] = rng.uniform(-0.5, 0.5);
        const Vec3 centre = 4.0 * (Vec3(i % 5, i / 5 % 5, i / 25) + 0.5) + jitter;
        std::vector<outcrop::Plane> planes;
        for (int k = 0; k < 20; ++k) {
          const Vec3 normal = rng.direction();
          planes.push_back({normal, -glm::dot(normal, centre) - rng.uniform(1.4, 1.9)});
        }
        blocks.push_back(std::make_shared<outcrop::RoundedPolytope>(planes, centre, 0.25,
                                                                    with_warp ? relief : outcrop::Warp{}));
      }
      made[with_warp] = outcrop::union_of(std::move(blocks));
    }
    return made;
  }();
  return tiles[warp];
}

outcrop::Box tile_region() { return {Vec3(-2.0), Vec3(kTileSide + 2.0)}; }

void mesh_tile(benchmark::State& state, double tolerance) {
  const outcrop::ThreadLimit limit(static_cast<int>(state.range(1)));
  const FieldPtr& field = tile(state.range(0) != 0);
  const PolygonizeOptions options{
      .region = tile_region(), .resolution = 0.1, .tolerance = tolerance, .keep_voids = true};
  std::size_t triangles = 0;
  for (auto _ : state) triangles = outcrop::polygonize(*field, options).mesh.triangles.size();
  report(state, triangles);
}

/// Hills of 80 m with one outcrop of blocks: smooth ground, and rock on a hundredth of it.
class Ground final : public outcrop::Field {
 public:
  void values(const Points& p, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t i = 0; i < p.size(); ++i)
      values[i] = (p.z[i] - 10.0 - 2.0 * std::sin(0.15 * p.x[i]) * std::sin(0.12 * p.y[i])) / kSlope;
    for (std::size_t i = 0; i < gradients.size(); ++i)
      gradients[i] = Vec3(-0.3 * std::cos(0.15 * p.x[i]) * std::sin(0.12 * p.y[i]),
                          -0.24 * std::sin(0.15 * p.x[i]) * std::cos(0.12 * p.y[i]), 1.0) / kSlope;
  }
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }

 private:
  static constexpr double kSlope = 1.08;
};

FieldPtr outcrop_on_hills() {
  const outcrop::Box spot{{6, 6, 6}, {14, 14, 14}};
  std::vector<outcrop::Plane> sides;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vec3 normal(0.0);
      normal[axis] = sign;
      sides.push_back({normal, -sign * (sign < 0 ? spot.lo : spot.hi)[axis]});
    }
  const auto inside = std::make_shared<outcrop::RoundedPolytope>(sides, spot.centre(), 0.0);
  return outcrop::union_of({std::make_shared<Ground>(), outcrop::intersection_of({inside, tile(true)})});
}

/// Off the surface by |f| / |∇f|, for points spread over the area: mean, root mean square, largest.
std::array<double, 3> errors(const outcrop::Field& field, const outcrop::TriangleMesh& mesh) {
  constexpr std::size_t kPoints = 200'000;
  std::vector<double> area;
  const auto corner = [&](std::uint32_t v) { return mesh.origin + Vec3(mesh.positions[v]); };
  for (const auto& t : mesh.triangles)
    area.push_back(glm::length(glm::cross(corner(t[1]) - corner(t[0]), corner(t[2]) - corner(t[0]))));
  std::partial_sum(area.begin(), area.end(), area.begin());
  double sum = 0.0, squares = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    outcrop::Rng rng(1, "points", i);
    const double place = (static_cast<double>(i) + rng.uniform()) / kPoints * area.back();
    const auto& t = mesh.triangles[std::upper_bound(area.begin(), area.end() - 1, place) - area.begin()];
    double u = rng.uniform(), v = rng.uniform();
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const Vec3 p = (1.0 - u - v) * corner(t[0]) + u * corner(t[1]) + v * corner(t[2]);
    const double error = std::abs(field.value(p)) / std::max(glm::length(field.gradient(p)), 0.1);
    sum += error;
    squares += error * error;
    largest = std::max(largest, error);
  }
  return {sum / kPoints, std::sqrt(squares / kPoints), largest};
}

void adaptivity(benchmark::State& state) {
  const FieldPtr field = outcrop_on_hills();
  PolygonizeOptions options{.region = {Vec3(0.0), {80, 80, 20}}, .resolution = 0.1};
  const auto uniform = outcrop::polygonize(*field, options).mesh;
  options.tolerance = 0.01 * static_cast<double>(state.range(0)) * options.resolution;
  options.crisp = state.range(1) != 0;
  outcrop::TriangleMesh adaptive;
  for (auto _ : state) adaptive = outcrop::polygonize(*field, options).mesh;
  report(state, adaptive.triangles.size());
  const auto before = errors(*field, uniform), after = errors(*field, adaptive);
  state.counters["uniform_error_mean"] = before[0] / options.resolution;
  state.counters["uniform_error_rms"] = before[1] / options.resolution;
  state.counters["uniform_error_max"] = before[2] / options.resolution;
  state.counters["error_mean"] = after[0] / options.resolution;
  state.counters["error_rms"] = after[1] / options.resolution;
  state.counters["error_max"] = after[2] / options.resolution;
  state.counters["fewer"] =
      static_cast<double>(uniform.triangles.size()) / static_cast<double>(adaptive.triangles.size());
}

void budget(benchmark::State& state) {
  const FieldPtr field = outcrop_on_hills();
  PolygonizeOptions options{.region = {Vec3(0.0), {80, 80, 20}}, .resolution = 0.1};
  options.triangles = static_cast<std::size_t>(state.range(0));
  std::size_t triangles = 0;
  for (auto _ : state) triangles = outcrop::polygonize(*field, options).mesh.triangles.size();
  report(state, triangles);
}

// Arguments: relief or not, threads.
BENCHMARK_CAPTURE(mesh_tile, uniform, 0.0)
    ->ArgNames({"warp", "threads"})
    ->Args({0, 1})
    ->Args({1, 1})
    ->Args({1, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(mesh_tile, adaptive, 0.05)
    ->ArgNames({"warp", "threads"})
    ->Args({1, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK(adaptivity)
    ->ArgNames({"tolerance_percent", "crisp"})
    ->ArgsProduct({{1, 4, 10}, {0, 1}})
    ->Args({0, 1})
    ->Args({6, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK(budget)->ArgNames({"wanted"})->Arg(200'000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

// Arguments: cells along the region, threads. CPU time of all threads, so that rates are those of one core.
BENCHMARK_CAPTURE(ball, sheet, Border::Open, Parts::All)
    ->Args({256, 1})
    ->Args({512, 1})
    ->Args({512, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(ball, grounded, Border::Open, Parts::Grounded)
    ->Args({512, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(hills, sheet, Border::Open, Parts::All)
    ->Args({512, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(hills, solid, Border::Closed, Parts::Grounded)
    ->Args({512, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK(check)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK(estimate)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace

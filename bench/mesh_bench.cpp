/// Triangles per second of the mesher: uniform cells, roots and normals, on fields that cost next to nothing.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <span>

#include "outcrop/core/parallel.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"

namespace {

using outcrop::Border;
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

// Fracture tiles: generation by type at the paper's setting, its stages, and growth with the number of samples.
#include <benchmark/benchmark.h>

#include <cmath>

#include "outcrop/core/parallel.h"
#include "outcrop/fracture/clusters.h"
#include "outcrop/fracture/samples.h"
#include "outcrop/fracture/tile.h"

namespace {

using namespace outcrop;

// A whole tile of 14 500 samples, hulls and statistics included, on one thread.
void tile(benchmark::State& state) {
  const ThreadLimit one(1);
  const BlockType type = kBlockTypes[state.range(0)];
  std::size_t blocks = 0;
  for (auto _ : state) blocks = make_tile({.type = type}, 1).blocks.size();
  state.SetLabel(std::string(name(type)) + ", " + std::to_string(blocks) + " blocks");
}
BENCHMARK(tile)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);

void grow(benchmark::State& state, const TileOptions& options) {
  const ThreadLimit one(1);
  TileStatistics statistics;
  for (auto _ : state) statistics = make_tile(options, 1).statistics;
  const auto samples = static_cast<double>(statistics.samples);
  state.counters["samples"] = samples;
  state.counters["blocks"] = static_cast<double>(statistics.clusters);
  state.counters["time/sample"] =
      benchmark::Counter(samples, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// The same rock in a tile of n times the volume, n times the samples and joints: the time a sample must not grow.
void growth(benchmark::State& state) {
  const double side = 20.0 * std::cbrt(static_cast<double>(state.range(0)));
  JointPattern pattern = joint_pattern(BlockType::Polyhedral);
  pattern.discs *= static_cast<int>(state.range(0));  // the same joints a volume
  grow(state,
       {.type = BlockType::Polyhedral, .pattern = pattern, .side = side, .spacing = 20.0 / kSpacingsPerSide});
}
BENCHMARK(growth)->Arg(1)->Arg(10)->Arg(70)->Unit(benchmark::kMillisecond);

// The same with all that sets can say: beds, joints that end at them, discs by P32, one by hand.
void joint_sets(benchmark::State& state) {
  const double side = 20.0 * std::cbrt(static_cast<double>(state.range(0)));
  const JointPattern pattern{
      .sets = {{.name = "beds",
                .normal = {0, 0, 1},
                .kappa = 500,
                .spacing = 1.8,
                .spacing_law = SpacingLaw::Lognormal,
                .radius_law = RadiusLaw::Persistent},
               {.name = "dip joints",
                .normal = {1, 0, 0},
                .kappa = 200,
                .spacing = 3.5,
                .radius_law = RadiusLaw::Persistent,
                .ends_at = {"beds"},
                .ends_share = 0.9},
               {.name = "strike joints",
                .normal = {0, 1, 0},
                .kappa = 200,
                .spacing = 3.0,
                .persistence = 0.8,
                .radius_lo = 2.0,
                .radius_hi = 5.0,
                .ends_at = {"beds", "dip joints"}},
               {.name = "others",
                .normal = {0.6, 0.0, 0.8},
                .kappa = 20,
                .p32 = 0.05,
                .radius_law = RadiusLaw::PowerLaw,
                .radius_lo = 2.0,
                .radius_hi = 10.0}},
      .discs_at = {{.centre = {5, 5, 5}, .radius = 4.0, .normal = {0, 0.6, 0.8}}}};
  grow(state, {.pattern = pattern, .side = side, .spacing = 20.0 / kSpacingsPerSide});
}
BENCHMARK(joint_sets)->Arg(1)->Arg(10)->Arg(70)->Unit(benchmark::kMillisecond);

// The same joints in the same tile, judged by n times the samples.
void refinement(benchmark::State& state) {
  const double finer = std::cbrt(static_cast<double>(state.range(0)));
  grow(state, {.type = BlockType::Polyhedral, .spacing = 20.0 / kSpacingsPerSide / finer});
}
BENCHMARK(refinement)->Arg(1)->Arg(10)->Arg(70)->Unit(benchmark::kMillisecond);

void samples(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(poisson_samples(20.0, 20.0 / kSpacingsPerSide, 1));
}
BENCHMARK(samples)->Unit(benchmark::kMillisecond);

void graph(benchmark::State& state) {
  const auto points = poisson_samples(20.0, 20.0 / kSpacingsPerSide, 1);
  for (auto _ : state) benchmark::DoNotOptimize(neighbour_graph(points, 20.0, 32.0 / kSpacingsPerSide));
}
BENCHMARK(graph)->Unit(benchmark::kMillisecond);

}  // namespace

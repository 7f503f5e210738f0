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
  pattern.discs *= static_cast<int>(state.range(0));  // the same joints a volume, as long in metres
  for (JointSet& set : pattern.sets) {
    set.radius_lo *= 20.0 / side;
    set.radius_hi *= 20.0 / side;
  }
  pattern.centre_spacing *= 20.0 / side;
  pattern.least_thickness *= 20.0 / side;
  grow(state,
       {.type = BlockType::Polyhedral, .pattern = pattern, .side = side, .spacing = 20.0 / kSpacingsPerSide});
}
BENCHMARK(growth)->Arg(1)->Arg(10)->Arg(70)->Unit(benchmark::kMillisecond);

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

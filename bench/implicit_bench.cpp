/// Time a point of rounded polytopes, with and without a relief: counters `s_point` and `s_plane_point`.
///
/// OUTCROP_BENCH_MODEL=<file> adds a model of many blocks: first line N and R, then per block the number of planes and,
/// per plane, nx ny nz d. Its field is the minimum over the blocks.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop {
namespace {

constexpr double kRounding = 0.25;

[[nodiscard]] Warp rough_warp() {
  Image image{.width = 512, .height = 512, .channels = 1};
  image.pixels.resize(512 * 512);
  Rng rng(1, "bench relief");
  for (float& pixel : image.pixels) pixel = static_cast<float>(rng.uniform());
  return {std::make_shared<const Relief>(Relief(image, 4.0).smoothed(0.1)), 0.1};
}

[[nodiscard]] PolytopeKernel random_kernel(int count, const Warp& warp) {
  std::vector<Plane> planes;
  Rng rng(1, "bench planes");
  for (int i = 0; i < count; ++i) {
    const Vec3 normal = rng.direction();
    planes.push_back({normal, -2.0 * rng.uniform(0.6, 1.0)});
  }
  return {planes, kRounding, warp, Vec3(12.0, 34.0, 56.0)};
}

/// Points of a lattice of n³ over the cube [−edge/2, edge/2]³ around `centre`.
struct Lattice {
  std::vector<float> x, y, z;
  Lattice(int n, double edge, Vec3 centre) {
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const Vec3 p = centre + edge * (Vec3(i, j, k) / double(n - 1) - Vec3(0.5));
          x.push_back(static_cast<float>(p.x));
          y.push_back(static_cast<float>(p.y));
          z.push_back(static_cast<float>(p.z));
        }
  }
};

void run(benchmark::State& state, const PolytopeKernel& kernel, const Lattice& points, bool gradients) {
  std::vector<float> values(points.x.size());
  std::vector<Vec3f> directions(points.x.size());
  for (auto _ : state) {
    kernel.values(values.size(), points.x.data(), points.y.data(), points.z.data(), values.data(),
                  gradients ? directions.data() : nullptr);
    benchmark::DoNotOptimize(values.data());
  }
  const auto inverted = benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert;
  state.counters["s_point"] = benchmark::Counter(static_cast<double>(values.size()), inverted);
  state.counters["s_plane_point"] =
      benchmark::Counter(static_cast<double>(values.size() * kernel.plane_count()), inverted);
  state.counters["planes"] = static_cast<double>(kernel.plane_count());
}

/// All planes, points everywhere in the block. Arguments: planes, warp, gradients.
void whole_block(benchmark::State& state) {
  run(state, random_kernel(static_cast<int>(state.range(0)), state.range(1) ? rough_warp() : Warp{}),
      Lattice(20, 4.0, Vec3(0.0)), state.range(2));
}
BENCHMARK(whole_block)
    ->ArgNames({"planes", "warp", "gradients"})
    ->ArgsProduct({{20}, {0, 1}, {0, 1}})
    ->ArgsProduct({{3}, {0, 1}, {0}});

/// A brick of 9³ points, 10 cm apart, on the surface: narrowed, then evaluated.
void narrowed_brick(benchmark::State& state) {
  const Vec3 centre = 1.4 * glm::normalize(Vec3(1, 2, 3));
  const Box box{centre - Vec3(0.4), centre + Vec3(0.4)};
  run(state, random_kernel(20, state.range(0) ? rough_warp() : Warp{}).narrow(TurnedBox(box)), Lattice(9, 0.8, centre), false);
}
BENCHMARK(narrowed_brick)->ArgNames({"warp"})->Arg(0)->Arg(1);

void narrowing(benchmark::State& state) {
  const Vec3 centre = 1.4 * glm::normalize(Vec3(1, 2, 3));
  const Box box{centre - Vec3(0.4), centre + Vec3(0.4)};
  const PolytopeKernel kernel = random_kernel(20, state.range(0) ? rough_warp() : Warp{});
  for (auto _ : state) benchmark::DoNotOptimize(kernel.narrow(TurnedBox(box)));
}
BENCHMARK(narrowing)->ArgNames({"warp"})->Arg(0)->Arg(1);

[[nodiscard]] FieldPtr read_model(const char* path, const Warp& warp) {
  std::ifstream file(path);
  std::size_t blocks = 0;
  double rounding = 0.0;
  file >> blocks >> rounding;
  std::vector<FieldPtr> fields(blocks);
  for (FieldPtr& field : fields) {
    std::size_t count = 0;
    file >> count;
    std::vector<Plane> planes(count);
    for (Plane& plane : planes) {
      file >> plane.normal.x >> plane.normal.y >> plane.normal.z >> plane.offset;
      plane.normal = glm::normalize(plane.normal);
    }
    field = std::make_shared<RoundedPolytope>(planes, Vec3(0.0), rounding, warp);
  }
  return file ? union_of(std::move(fields)) : nullptr;
}

/// Counts of one descent.
struct Descent {
  std::size_t points = 0, bricks = 0;
};

/// Narrows as a mesher does, halving the box, and evaluates bricks of 9³ points, 10 cm apart, that `bound` cannot
/// exclude.
void descend(const Field& field, const Box& box, Descent& counts) {
  constexpr double kBrick = 0.8;
  const Interval bound = field.bound(box);
  if (bound.lo > 0.0 || bound.hi < 0.0) return;
  const FieldPtr narrowed = field.narrow(box);
  if (box.size().x > 1.5 * kBrick) {
    const Vec3 half = 0.5 * box.size();
    for (int child = 0; child < 8; ++child) {
      const Vec3 lo = box.lo + half * Vec3(child & 1, child >> 1 & 1, child >> 2);
      descend(*narrowed, {lo, lo + half}, counts);
    }
    return;
  }
  std::array<double, 729> x, y, z, values;
  for (int i = 0; i < 729; ++i) {
    x[i] = box.lo.x + 0.1 * (i % 9);
    y[i] = box.lo.y + 0.1 * (i / 9 % 9);
    z[i] = box.lo.z + 0.1 * (i / 81);
  }
  narrowed->values({x, y, z}, values, {});
  benchmark::DoNotOptimize(values.data());
  counts.points += values.size();
  ++counts.bricks;
}

/// One value at a random point of the model's cube, one call each, from a field narrowed to its box of 0.8 m: what a host
/// pays that asks point by point. So many points in a row are in the same of 32 768 boxes; where each is in another,
/// most of the time goes into reading that box's planes from beyond the cache.
void random_value(benchmark::State& state) {
  constexpr int kBoxes = 32;
  const char* const path = std::getenv("OUTCROP_BENCH_MODEL");
  const FieldPtr field = path ? read_model(path, state.range(0) ? rough_warp() : Warp{}) : nullptr;
  if (!field) {
    state.SkipWithError("set OUTCROP_BENCH_MODEL to a model file");
    return;
  }
  std::vector<FieldPtr> boxes(kBoxes * kBoxes * kBoxes);
  const double side = 25.6 / kBoxes;
  for (int i = 0; i < kBoxes * kBoxes * kBoxes; ++i) {
    const Vec3 lo = Vec3(-12.8) + side * Vec3(i % kBoxes, i / kBoxes % kBoxes, i / (kBoxes * kBoxes));
    boxes[i] = field->narrow({lo, lo + side});
  }
  std::vector<Vec3> points;
  Rng rng(1, "bench points");
  for (int i = 0; i < 4096; ++i) {
    const double x = rng.uniform(-12.8, 12.8);
    const double y = rng.uniform(-12.8, 12.8);
    const double z = rng.uniform(-12.8, 12.8);
    const Vec3 lo = side * glm::floor(Vec3(x, y, z) / side);
    points.emplace_back(x, y, z);
    for (std::int64_t k = 1; k < state.range(1); ++k) {
      const double u = rng.uniform();
      const double v = rng.uniform();
      const double w = rng.uniform();
      points.push_back(lo + side * Vec3(u, v, w));
    }
  }
  std::size_t next = 0;
  for (auto _ : state) {
    const Vec3& p = points[next++ % points.size()];
    const IVec3 box((p + 12.8) / side);
    benchmark::DoNotOptimize(boxes[(box.z * kBoxes + box.y) * kBoxes + box.x]->value(p));
  }
}
BENCHMARK(random_value)->ArgNames({"warp", "in_a_box"})->ArgsProduct({{0, 1}, {1, 32}});

/// The model's cube of 25.6 m in bricks: everything from the root to the values, per point evaluated.
void model(benchmark::State& state) {
  const char* const path = std::getenv("OUTCROP_BENCH_MODEL");
  const FieldPtr field = path ? read_model(path, state.range(0) ? rough_warp() : Warp{}) : nullptr;
  if (!field) {
    state.SkipWithError("set OUTCROP_BENCH_MODEL to a model file");
    return;
  }
  Descent counts;
  for (auto _ : state) descend(*field, {Vec3(-12.8), Vec3(12.8)}, counts);
  state.counters["s_point"] =
      benchmark::Counter(static_cast<double>(counts.points), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["bricks"] = static_cast<double>(counts.bricks) / static_cast<double>(state.iterations());
}
BENCHMARK(model)->ArgNames({"warp"})->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace outcrop

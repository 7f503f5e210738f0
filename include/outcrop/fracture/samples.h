/// Blue-noise samples of a periodic cube and the graph of their neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/core/task.h"
#include "outcrop/core/vec.h"

namespace outcrop {

/// Finest spacing: side / kFinestSpacing, some three million samples.
inline constexpr double kFinestSpacing = 160.0;

/// A maximal Poisson-disc set on the torus [0, side)³: no two samples closer than `spacing`, borders included.
/// Maximal: every point of the torus lies within `spacing` of a sample, up to a millionth of it. That makes about
/// 0.74 (side / spacing)³ samples (random sequential packing jams at 0.73).
/// @throws ParameterError unless side / 160 ≤ spacing ≤ side / 4. Cost: linear in the number of samples,
/// about 3 µs each. Method: darts into uncovered cubes, then gaps by halving the cubes @cite ebeida_2012.
[[nodiscard]] std::vector<Vec3> poisson_samples(double side, double spacing, Seed seed, const Task& task = {});

/// The shortest vector from a to b on the torus, each component in [−side/2, side/2).
[[nodiscard]] Vec3 wrapped_difference(const Vec3& a, const Vec3& b, double side) noexcept;
[[nodiscard]] double wrapped_distance(const Vec3& a, const Vec3& b, double side) noexcept;

/// Undirected neighbours in compressed rows: those of i are targets[first[i] … first[i + 1]).
struct Graph {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> targets;
};

/// All pairs within `radius` on the torus. Cost: linear in samples and edges (cell grid).
[[nodiscard]] Graph neighbour_graph(const std::vector<Vec3>& samples, double side, double radius);

}  // namespace outcrop

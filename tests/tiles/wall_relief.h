/// The relief of a plane wall of replicated blocks, and how much of it repeats.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "outcrop/core/parallel.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/tiles/replication.h"

namespace outcrop::test {

/// Depths behind the plane of a wall, row by row from its foot, metres.
struct WallRelief {
  int columns = 0, rows = 0;
  double step = 0.0;
  std::vector<double> depth;

  [[nodiscard]] double at(int column, int row) const {
    return depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
  /// Of the depths and those `lag` metres along the wall, their mean removed: 1 at 0.
  [[nodiscard]] double autocorrelation(double lag) const {
    double mean = 0.0, variance = 0.0, sum = 0.0;
    for (const double d : depth) mean += d / static_cast<double>(depth.size());
    for (const double d : depth) variance += (d - mean) * (d - mean) / static_cast<double>(depth.size());
    const int shift = static_cast<int>(std::lround(lag / step));
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column + shift < columns; ++column)
        sum += (at(column, row) - mean) * (at(column + shift, row) - mean);
    return sum / (static_cast<double>(rows) * (columns - shift) * variance);
  }
};

struct Wall {
  bool along_y = false;  ///< Else along x.
  double offset = 0.0;   ///< Of its plane from the lattice's corner, metres.
  double length = 200.0, height = 40.0;
};

/// Blocks stand as amplify() places them, in front of a base that is recessed by 1.8 block sizes; no relief on the blocks.
inline WallRelief wall_relief(const Tile& tile, const Wall& wall, double step = 0.4) {
  double volume = 0.0;
  for (const Block& block : tile.blocks) volume += block.volume / static_cast<double>(tile.blocks.size());
  const double size = std::cbrt(volume);
  const double reach = 1.8 * size;
  const Vec3 outwards = wall.along_y ? Vec3(-1, 0, 0) : Vec3(0, -1, 0);
  const Vec3 along = wall.along_y ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
  const Vec3 corner = -wall.offset * outwards;
  Box domain{corner, corner};
  domain.include(corner + wall.length * along + wall.height * Vec3(0, 0, 1));
  const auto rock = std::make_shared<Replication>(
      Rock{.tile = tile}, half_space({.normal = outwards, .offset = -glm::dot(outwards, corner)}),
      ReplicationOptions{.domain = domain.grown(reach), .criterion = distance_between(-1000.0 * size, 0.05 * size),
                         .cap = 0.1 * size});
  WallRelief relief{.columns = static_cast<int>(wall.length / step), .rows = static_cast<int>(wall.height / step), .step = step};
  relief.depth.resize(static_cast<std::size_t>(relief.columns) * static_cast<std::size_t>(relief.rows));
  constexpr int kPatch = 8;
  const int patches = (relief.columns + kPatch - 1) / kPatch;
  parallel_for(static_cast<std::size_t>(patches) * static_cast<std::size_t>((relief.rows + kPatch - 1) / kPatch), [&](std::size_t i) {
    const int first = static_cast<int>(i) % patches * kPatch, row0 = static_cast<int>(i) / patches * kPatch;
    const auto point = [&](int column, int row, double depth) {
      return corner + (column + 0.5) * step * along + (row + 0.5) * step * Vec3(0, 0, 1) - depth * outwards;
    };
    Box box;
    box.include(point(first, row0, -reach));
    box.include(point(first + kPatch, row0 + kPatch, reach));
    const FieldPtr near = rock->narrow(box);
    for (int row = row0; row < std::min(row0 + kPatch, relief.rows); ++row)
      for (int column = first; column < std::min(first + kPatch, relief.columns); ++column) {
        double depth = -reach;
        while (depth < reach) {
          const double value = near->value(point(column, row, depth));
          if (value < 1e-3) break;
          depth += value;
        }
        relief.depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(relief.columns) + static_cast<std::size_t>(column)] =
            std::min(depth, reach);
      }
  });
  return relief;
}

/// The largest autocorrelation at multiples of `period`, up to half the wall.
inline double repetition(const WallRelief& relief, double period) {
  double largest = -1.0;
  for (double lag = period; lag <= 0.5 * relief.columns * relief.step + 1e-9; lag += period)
    largest = std::max(largest, relief.autocorrelation(lag));
  return largest;
}

}  // namespace outcrop::test

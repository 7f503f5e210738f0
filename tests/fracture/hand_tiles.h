/// Tiles made by hand, of which everything is known.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/fracture/hull.h"
#include "outcrop/fracture/tile.h"

namespace outcrop::test {

/// Persistent joints across x, y and z at the given places in [0, side): boxes, with one set an axis.
inline Tile grid_tile(double side, const std::array<std::vector<double>, 3>& places, double aperture) {
  Tile tile;
  tile.side = side;
  tile.aperture = aperture;
  std::array<std::vector<int>, 3> discs;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 normal(0.0);
    normal[axis] = 1.0;
    tile.sets.push_back({.normal = normal});
    for (const double at : places[static_cast<std::size_t>(axis)]) {
      discs[static_cast<std::size_t>(axis)].push_back(static_cast<int>(tile.discs.size()));
      tile.discs.push_back({at * normal, side, normal, axis});
    }
  }
  double filled = 0.0;
  std::array<std::size_t, 3> i{};
  for (i[0] = 0; i[0] < places[0].size(); ++i[0])
    for (i[1] = 0; i[1] < places[1].size(); ++i[1])
      for (i[2] = 0; i[2] < places[2].size(); ++i[2]) {
        Block block;
        Vec3 size;
        for (int axis = 0; axis < 3; ++axis) {
          const auto a = static_cast<std::size_t>(axis);
          const std::size_t next = (i[a] + 1) % places[a].size();
          const double lo = places[a][i[a]];
          const double hi = places[a][next] + (next <= i[a] ? side : 0.0);
          size[axis] = hi - lo - aperture;
          block.centre[axis] = std::fmod(0.5 * (lo + hi), side);
          Vec3 normal(0.0);
          normal[axis] = 1.0;
          block.planes.push_back({normal, -0.5 * size[axis]});
          block.plane_joint.push_back(discs[a][next]);
          block.planes.push_back({-normal, -0.5 * size[axis]});
          block.plane_joint.push_back(discs[a][i[a]]);
        }
        std::vector<Vec3> corners;
        for (int corner = 0; corner < 8; ++corner)
          corners.push_back(0.5 * size * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
        block.bounds = {-0.5 * size, 0.5 * size};
        block.hull = convex_hull(corners).value();
        block.volume = size.x * size.y * size.z;
        filled += block.volume / (side * side * side);
        tile.blocks.push_back(std::move(block));
      }
  tile.statistics.filled_share = filled;
  return tile;
}

/// `count` places in [0, side), uniform: spacings are close to exponential.
inline std::vector<double> random_places(double side, int count, Seed seed, std::string_view purpose) {
  std::vector<double> places;
  for (int i = 0; i < count; ++i) places.push_back(side * Rng(seed, purpose, static_cast<std::uint64_t>(i)).uniform());
  std::sort(places.begin(), places.end());
  return places;
}

/// `count` places in [0, side), all `side / count` apart.
inline std::vector<double> even_places(double side, int count) {
  std::vector<double> places;
  for (int i = 0; i < count; ++i) places.push_back((i + 0.3) * side / count);
  return places;
}

}  // namespace outcrop::test

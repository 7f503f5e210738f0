#include "overlap.h"

#include <algorithm>
#include <cmath>

namespace outcrop {
namespace {

constexpr double kCellsPerBlock = 2.5;  // An axis: few blocks a cell, few cells a block.

struct BlockImage {
  std::uint32_t block;
  Vec3 centre;
};

}  // namespace

double overlap_share(const Tile& tile, std::size_t probes, Seed seed) {
  const int count = 1 + static_cast<int>(kCellsPerBlock * std::cbrt(static_cast<double>(tile.blocks.size())));
  const auto index = [&](const IVec3& c) { return (static_cast<std::size_t>(c.z) * count + c.y) * count + c.x; };
  std::vector<std::vector<BlockImage>> cells(static_cast<std::size_t>(count) * count * count);
  const double width = tile.side / count;
  for (std::uint32_t b = 0; b < tile.blocks.size(); ++b) {
    const Block& block = tile.blocks[b];
    const IVec3 lo(glm::floor((block.centre + block.bounds.lo) / width));
    const IVec3 hi(glm::floor((block.centre + block.bounds.hi) / width));
    for (int z = lo.z; z <= hi.z; ++z)
      for (int y = lo.y; y <= hi.y; ++y)
        for (int x = lo.x; x <= hi.x; ++x) {
          const IVec3 turn(glm::floor(Vec3(x, y, z) / static_cast<double>(count)));
          const IVec3 c = IVec3(x, y, z) - count * turn;
          cells[index(c)].push_back({b, block.centre - tile.side * Vec3(turn)});
        }
  }
  std::size_t covered_twice = 0;
  Rng rng(seed, "overlap probes");
  for (std::size_t i = 0; i < probes; ++i) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = tile.side * rng.uniform();
    const IVec3 c = glm::min(IVec3(p / width), IVec3(count - 1));
    int covers = 0;
    for (const BlockImage& image : cells[index(c)]) {
      const std::vector<Plane>& planes = tile.blocks[image.block].planes;
      const Vec3 q = p - image.centre;
      covers += std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) { return plane.distance(q) < 0.0; });
    }
    covered_twice += covers > 1;
  }
  return static_cast<double>(covered_twice) / static_cast<double>(std::max<std::size_t>(probes, 1));
}

}  // namespace outcrop

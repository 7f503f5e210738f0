// How much of a wall's relief repeats: the autocorrelation of plane walls, 200 m by 40 m, at multiples of the tile's side,
// 20 to 100 m. Of six walls (along x and y, at three depths) the mean, and the largest of one wall; the greatest over the
// multiples. The same half a tile beside the multiples shows what is chance or trend. And what variants cost: processor
// time, and bytes of the blocks of a cube of 200 m.
#include <chrono>
#include <ctime>
#include <cstdio>
#include <fstream>
#include <string>

#include "tiles/wall_relief.h"

namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// A grey picture of the relief, 4 pixels a metre: light from the upper left.
void write_picture(const outcrop::test::WallRelief& relief, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << "P5\n" << relief.columns << ' ' << relief.rows << "\n255\n";
  for (int row = relief.rows - 1; row >= 0; --row)
    for (int column = 0; column < relief.columns; ++column) {
      const double dx = relief.at(std::min(column + 1, relief.columns - 1), row) - relief.at(column, row);
      const double dz = relief.at(column, std::min(row + 1, relief.rows - 1)) - relief.at(column, row);
      const double shade = 150.0 - 18.0 * relief.at(column, row) - 60.0 * (dx - dz) / (std::hypot(dx, dz) + 0.5);
      file.put(static_cast<char>(std::clamp(shade, 0.0, 255.0)));
    }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace outcrop;
  const std::string folder = argc > 1 ? argv[1] : "";  // for pictures of the first wall of each type
  std::printf("%-16s %8s %8s %8s %8s %8s %8s %10s\n", "type", "variants", "mean", "largest", "mean/2", "largest/2", "make_s", "bytes");
  for (const BlockType type : kBlockTypes)
    for (const int variants : {1, 8}) {
      const double start = processor_seconds();
      const Tile tile = make_tile({.type = type, .variants = variants}, 1);
      const double seconds = processor_seconds() - start;
      std::vector<double> mean(11, 0.0);  // at multiples of half a tile
      std::vector<double> largest(11, -1.0);
      for (const bool along_y : {false, true})
        for (const double offset : {3.0, 10.0, 16.0}) {
          const test::WallRelief relief = test::wall_relief(tile, {.along_y = along_y, .offset = offset});
          for (std::size_t i = 2; i < mean.size(); ++i) {
            const double r = relief.autocorrelation(0.5 * static_cast<double>(i) * tile.side);
            mean[i] += r / 6.0;
            largest[i] = std::max(largest[i], r);
          }
          if (!folder.empty() && !along_y && offset == 3.0)
            write_picture(relief, folder + "/" + std::string(name(type)) + "_" + std::to_string(variants) + ".pgm");
        }
      const auto most = [](const std::vector<double>& of, std::size_t first) {
        double result = -1.0;
        for (std::size_t i = first; i < of.size(); i += 2) result = std::max(result, of[i]);
        return result;
      };
      const Replication node(Rock{.tile = tile}, half_space({}), {.domain = {Vec3(0.0), Vec3(200.0)}});
      std::printf("%-16s %8d %8.3f %8.3f %8.3f %8.3f %8.3f %10zu\n", std::string(name(type)).c_str(), variants, most(mean, 2),
                  most(largest, 2), most(mean, 3), most(largest, 3), seconds, node.tile_bytes());
      std::fflush(stdout);
    }
}

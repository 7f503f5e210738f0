// Makes a box of rock from a strata file and cuts it level: traces as comma separated text, for bench/outcrops.py.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "outcrop/amplify/strata_file.h"
#include "outcrop/fracture/trace_map.h"

using namespace outcrop;

// outcrop_cut STRATA SEED LEVELS: the first material, cut at LEVELS heights.
int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: outcrop_cut STRATA SEED LEVELS\n", stderr);
    return 2;
  }
  try {
    const RockMaterial material = read_strata(argv[1]).materials.front();
    TileOptions options = tile_options(material, kPatternSide);
    options.domain = Domain::Box;
    const Tile tile = make_tile(options, std::strtoull(argv[2], nullptr, 10));
    std::printf("# blocks %zu, seconds %.1f\n", tile.blocks.size(), tile.statistics.seconds);
    const int levels = std::atoi(argv[3]);
    for (int i = 0; i < levels; ++i) {
      const CutPlane cut{.origin = Vec3(0, 0, (i + 0.5) / levels * tile.side), .width = tile.side, .height = tile.side};
      std::printf("# level %d\n%s", i, trace_table(tile, trace_map(tile, cut)).c_str());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "outcrop_cut: %s\n", error.what());
    return 2;
  }
  return 0;
}

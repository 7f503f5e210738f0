// Prints docs/tile_statistics.md: tiles of every type at the paper's setting beside its Tables 1 and 2.
#include <cmath>
#include <cstdio>

#include "outcrop/core/vec.h"
#include "outcrop/fracture/tile.h"

namespace {

using namespace outcrop;

constexpr int kSeeds = 8;

struct Mean {
  double sum = 0.0, least = 1e300, most = -1e300;
  void add(double v) {
    sum += v;
    least = std::min(least, v);
    most = std::max(most, v);
  }
  [[nodiscard]] double value() const { return sum / kSeeds; }
};

// Bytes of what evaluates a block: planes as four floats, centre, rounding and bounds.
double field_bytes(const Tile& tile) {
  double bytes = 0.0;
  for (const Block& block : tile.blocks) bytes += 16.0 * static_cast<double>(block.planes.size()) + 40.0;
  return bytes;
}

const char* paper_counts(BlockType type) {  // Paris et al. 2020, Table 1: discs / blocks / samples a block
  switch (type) {
    case BlockType::Equidimensional:
      return "15 / 125 / 110";
    case BlockType::Rhombohedral:
      return "24 / 78 / 161";
    case BlockType::Polyhedral:
      return "44 / 100 / 140";
    case BlockType::Tabular:
      return "30 / 82 / 143";
    default:
      return "–";
  }
}

}  // namespace

int main() {
  std::puts("# Tile statistics\n");
  std::puts("Tiles of 20 m with the default options, means over seeds 1 to 8. Written by");
  std::puts("`build/release/bin/outcrop_tile_report > docs/tile_statistics.md`.\n");
  std::puts("## Beside Table 1 of Paris et al. 2020\n");
  std::puts(
      "| type | samples | discs | blocks (range) | samples a block | paper: discs / blocks / samples a block | joints "
      "added "
      "| chips kept whole | largest turn |");
  std::puts("|---|---|---|---|---|---|---|---|---|");
  std::string shapes;
  for (const BlockType type : kBlockTypes) {
    Mean samples, blocks, added, chips, turn, filled, overlap, planes, most, plain, plain_planes, plain_most, bytes;
    Mean elongation, flatness, variation, volume;
    for (Seed seed = 1; seed <= kSeeds; ++seed) {
      const Tile tile = make_tile({.type = type}, seed);
      const TileStatistics& s = tile.statistics;
      samples.add(static_cast<double>(s.samples));
      blocks.add(static_cast<double>(tile.blocks.size()));
      added.add(static_cast<double>(s.added_joints));
      chips.add(static_cast<double>(s.merged_chips));
      turn.add(degrees(s.largest_bend));
      filled.add(s.filled_share);
      overlap.add(s.overlap_share);
      planes.add(s.mean_planes);
      most.add(static_cast<double>(s.max_planes));
      plain.add(s.plain_filled_share);
      plain_planes.add(s.plain_mean_planes);
      plain_most.add(static_cast<double>(s.plain_max_planes));
      bytes.add(field_bytes(tile) / 1e6);
      const auto n = static_cast<double>(tile.blocks.size());
      double mean = 0.0, square = 0.0, log_elongation = 0.0, log_flatness = 0.0;
      for (const Block& block : tile.blocks) {
        const auto size = principal_sizes(block.hull);
        mean += block.volume / n;
        square += block.volume * block.volume / n;
        log_elongation += std::log(size[0] / size[1]) / n;
        log_flatness += std::log(size[1] / size[2]) / n;
      }
      volume.add(mean);
      variation.add(std::sqrt(square - mean * mean) / mean);
      elongation.add(std::exp(log_elongation));
      flatness.add(std::exp(log_flatness));
    }
    std::printf("| %s | %.0f | %d | %.0f (%.0f to %.0f) | %.0f | %s | %.0f | %.0f | %.1f° |\n", name(type).data(),
                samples.value(), joint_pattern(type).discs, blocks.value(), blocks.least, blocks.most,
                samples.value() / blocks.value(), paper_counts(type), added.value(), chips.value(), turn.most);
    char row[400];
    std::snprintf(
        row, sizeof row, "| %s | %.3f / %.3f | %.4f | %.1f / %.0f | %.1f / %.0f | %.3f | %.0f | %.2f | %.2f | %.2f |\n",
        name(type).data(), filled.value(), plain.value(), overlap.most, planes.value(), most.most, plain_planes.value(),
        plain_most.most, bytes.value(), volume.value(), variation.value(), elongation.value(), flatness.value());
    shapes += row;
  }
  std::puts("\n## Blocks\n");
  std::puts(
      "Filled: share of the cube inside blocks, ours and of plain hulls of the samples. Planes a block: mean / most, "
      "ours and");
  std::puts(
      "plain. Memory: planes as four floats, with centre, rounding and bounds; Table 2 of the paper has 0.53 to 0.57 "
      "MB.");
  std::puts("Elongation and flatness: longest to middle and middle to shortest principal size, geometric means.\n");
  std::puts(
      "| type | filled, ours / plain | overlap, most | planes, ours | planes, plain | MB | volume, m³ | volume CV | "
      "elongation "
      "| flatness |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|");
  std::fputs(shapes.c_str(), stdout);
}

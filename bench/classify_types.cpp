// Makes tiles of every type and lets the independent classification judge them: prints the confusion table.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "outcrop/core/parallel.h"
#include "outcrop/fracture/classify.h"

using namespace outcrop;

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 100;
  const bool with_figures = argc > 2;
  std::printf("| asked for \\ found |");
  for (const BlockType type : kBlockTypes) std::printf(" %s |", name(type).data());
  std::printf("\n|---|---|---|---|---|---|---|\n");
  int least = seeds;
  for (const BlockType type : kBlockTypes) {
    const auto found = parallel_map(static_cast<std::size_t>(seeds), [&](std::size_t i) {
      return classify(make_tile({.type = type}, static_cast<Seed>(i + 1)));
    });
    std::array<int, 6> counts{};
    for (const Classification& c : found) ++counts[static_cast<std::size_t>(c.type)];
    std::printf("| %s |", name(type).data());
    for (const int count : counts) std::printf(" %d |", count);
    std::printf("\n");
    least = std::min(least, counts[static_cast<std::size_t>(type)]);
    if (!with_figures) continue;
    const struct {
      const char* what;
      double Classification::* value;
    } figures[] = {{"sets", &Classification::set_share},
                   {"square", &Classification::square_share},
                   {"prism", &Classification::prism_share},
                   {"elongation", &Classification::elongation},
                   {"fabric elongation", &Classification::fabric_elongation},
                   {"fabric flatness", &Classification::fabric_flatness}};
    for (const auto& figure : figures) {
      std::vector<double> values;
      for (const Classification& c : found) values.push_back(c.*figure.value);
      std::sort(values.begin(), values.end());
      std::fprintf(stderr, "  %-18s least %.2f  5 %% %.2f  median %.2f  95 %% %.2f  greatest %.2f\n", figure.what,
                   values[0], values[values.size() / 20], values[values.size() / 2], values[values.size() * 19 / 20],
                   values.back());
    }
  }
  std::printf("\nThe type asked for is given back in at least %d of %d seeds.\n", least, seeds);
  return least >= seeds * 95 / 100 ? 0 : 1;
}

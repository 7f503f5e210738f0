#include "pyramid.h"

#include <algorithm>
#include <utility>

namespace outcrop::terrain {
namespace {

constexpr int kNodesPerSide = 4;  // A rectangle is covered by at most this many nodes a side: ≤ 1/4 of a side too much.

PatchBound hull(const PatchBound& a, const PatchBound& b) noexcept {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi), std::max(a.slope, b.slope), std::max(a.curvature, b.curvature)};
}

}  // namespace

Pyramid::Pyramid(int width, int height, std::vector<PatchBound> patches) {
  levels_.push_back({width, std::move(patches)});
  while (width > kNodesPerSide || height > kNodesPerSide) {
    const int w = (width + 1) / 2, h = (height + 1) / 2;
    const Level& fine = levels_.back();
    Level coarse{w, std::vector<PatchBound>(static_cast<std::size_t>(w) * h)};
    for (int r = 0; r < h; ++r) {
      for (int c = 0; c < w; ++c) {
        PatchBound& node = coarse.nodes[static_cast<std::size_t>(r) * w + c];
        node = fine.nodes[static_cast<std::size_t>(2 * r) * width + 2 * c];
        for (int y = 2 * r; y < std::min(2 * r + 2, height); ++y) {
          for (int x = 2 * c; x < std::min(2 * c + 2, width); ++x) {
            node = hull(node, fine.nodes[static_cast<std::size_t>(y) * width + x]);
          }
        }
      }
    }
    levels_.push_back(std::move(coarse));
    width = w;
    height = h;
  }
}

PatchBound Pyramid::bound(int c0, int c1, int r0, int r1) const noexcept {
  std::size_t level = 0;
  while (level + 1 < levels_.size() && (c1 - c0 >= kNodesPerSide || r1 - r0 >= kNodesPerSide)) {
    c0 /= 2, c1 /= 2, r0 /= 2, r1 /= 2;
    ++level;
  }
  const Level& nodes = levels_[level];
  PatchBound result = nodes.nodes[static_cast<std::size_t>(r0) * nodes.width + c0];
  for (int r = r0; r <= r1; ++r) {
    for (int c = c0; c <= c1; ++c) result = hull(result, nodes.nodes[static_cast<std::size_t>(r) * nodes.width + c]);
  }
  return result;
}

}  // namespace outcrop::terrain

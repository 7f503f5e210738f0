#include "brick_tree.h"

namespace outcrop::meshing {

const std::array<IVec3, 18>& face_and_edge_neighbours() {
  static const std::array<IVec3, 18> directions = [] {
    std::array<IVec3, 18> list;
    int n = 0;
    for (int i = 0; i < 27; ++i) {
      const IVec3 d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const int axes = (d.x != 0) + (d.y != 0) + (d.z != 0);
      if (axes == 1 || axes == 2) list[n++] = d;
    }
    return list;
  }();
  return directions;
}

void FinerCells::mark(const IVec3& lo, const IVec3& hi) noexcept {
  any_ = true;
  const unsigned cells = (1u << (hi.x + 1)) - (1u << (lo.x + 1));
  for (int z = lo.z; z < hi.z; ++z)
    for (int y = lo.y; y < hi.y; ++y) rows_[(z + 1) * kAcross + y + 1] |= static_cast<std::uint16_t>(cells);
}

std::uint64_t BrickTree::key(const BrickPlace& at) noexcept {
  const auto part = [](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i + 1)); };
  return part(at.level) << 60 | part(at.index.z) << 40 | part(at.index.y) << 20 | part(at.index.x);
}

BrickTree::State BrickTree::state(const BrickPlace& at) const {
  const State* found = cells_.find(key(at));
  return found ? *found : State::None;
}

void BrickTree::mark_parents_split(BrickPlace at) {
  for (;;) {
    at = {at.index >> 1, at.level + 1};
    if (at.level > kMaxLevels) return;
    State& parent = cells_[key(at)];
    if (parent == State::Split) return;
    parent = State::Split;
    split_[at.level].push_back(at.index);
  }
}

void BrickTree::add(const std::vector<BrickPlace>& leaves) {
  for (const BrickPlace& leaf : leaves) {
    cells_[key(leaf)] = State::Leaf;
    mark_parents_split(leaf);
  }
}

void BrickTree::split_down_to(const Lattice& lattice, const BrickPlace& at) {
  // The leaf around `at`, if it is larger.
  BrickPlace leaf = at;
  State found = state(leaf);
  while (found == State::None && leaf.level < lattice.coarsest) {
    leaf = {leaf.index >> 1, leaf.level + 1};
    found = state(leaf);
  }
  if (found != State::Leaf) return;
  while (leaf.level > at.level) {
    cells_[key(leaf)] = State::Split;
    split_[leaf.level].push_back(leaf.index);
    for (int octant = 0; octant < 8; ++octant) {
      const BrickPlace child{child_index(leaf.index, octant), leaf.level - 1};
      if (lattice.holds(child.index, child.level)) cells_[key(child)] = State::Leaf;
    }
    leaf = {at.index >> (leaf.level - 1 - at.level), leaf.level - 1};
  }
}

void BrickTree::balance(const Lattice& lattice) {
  for (int level = 1; level < lattice.coarsest; ++level)
    for (std::size_t i = 0; i < split_[level].size(); ++i)
      for (const IVec3& d : face_and_edge_neighbours()) {
        const BrickPlace neighbour{split_[level][i] + d, level};
        if (lattice.holds(neighbour.index, level)) split_down_to(lattice, neighbour);
      }
}

FinerCells BrickTree::finer_around(const BrickPlace& brick) const {
  FinerCells finer;
  if (brick.level == 0) return finer;
  constexpr int kHalf = kBrickCells / 2;
  for (const IVec3& d : face_and_edge_neighbours()) {
    const BrickPlace neighbour{brick.index + d, brick.level};
    if (!is_split(neighbour)) continue;
    for (int octant = 0; octant < 8; ++octant) {
      const BrickPlace child{child_index(neighbour.index, octant), brick.level - 1};
      // In cells of the brick; only what lies in the layer around it counts.
      const IVec3 lo = kHalf * (child.index - 2 * brick.index);
      const IVec3 from = glm::max(lo, IVec3(-1)), to = glm::min(lo + kHalf, IVec3(kBrickCells + 1));
      if (from.x < to.x && from.y < to.y && from.z < to.z && is_leaf(child)) finer.mark(from, to);
    }
  }
  return finer;
}

}  // namespace outcrop::meshing

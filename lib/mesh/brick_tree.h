/// Which bricks stand where: an octree in which neighbours differ by one level at most.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "flat_map.h"
#include "lattice.h"

namespace outcrop::meshing {

/// A brick's place: cells of 2^level lattice cells.
struct BrickPlace {
  IVec3 index{0};
  int level = 0;
};

/// The 18 neighbours of a cell that share a face or an edge with it.
[[nodiscard]] const std::array<IVec3, 18>& face_and_edge_neighbours();

/// Where finer cells lie around a brick: one flag for each cell of the brick and of the layer around it.
class FinerCells {
 public:
  [[nodiscard]] bool any() const noexcept { return any_; }
  /// The cells (−1, y, z) to (8, y, z), in cells of the brick, as bits 0 to 9; y and z are −1 to 8.
  [[nodiscard]] unsigned row(int y, int z) const noexcept { return rows_[(z + 1) * kAcross + y + 1]; }
  /// The 27 cells around and including `cell` of the brick, as bits (dx + 1) + 3 (dy + 1) + 9 (dz + 1).
  [[nodiscard]] unsigned around(const IVec3& cell) const noexcept {
    unsigned flags = 0;
    for (int i = 0; i < 9; ++i) flags |= (row(cell.y + i % 3 - 1, cell.z + i / 3 - 1) >> cell.x & 7) << 3 * i;
    return flags;
  }
  void mark(const IVec3& lo, const IVec3& hi) noexcept;  ///< Cells lo to hi − 1.

 private:
  static constexpr int kAcross = kBrickCells + 2;
  std::array<std::uint16_t, kAcross * kAcross> rows_{};
  bool any_ = false;
};

/// Leaves are bricks that may hold surface; where nothing stands there is none.
class BrickTree {
 public:
  /// @param leaves  Disjoint.
  void add(const std::vector<BrickPlace>& leaves);

  /// Splits leaves until no two that share a face or an edge differ by more than one level, and, to the same end, no
  /// leaf reaches into the neighbourhood of a split cell half its size. What a leaf becomes depends on leaves less than
  /// 2^coarsest bricks away.
  void balance(const Lattice& lattice);

  [[nodiscard]] bool is_leaf(const BrickPlace& at) const { return state(at) == State::Leaf; }
  [[nodiscard]] bool is_split(const BrickPlace& at) const { return state(at) == State::Split; }
  [[nodiscard]] FinerCells finer_around(const BrickPlace& brick) const;
  /// A number for the place, never 0.
  [[nodiscard]] static std::uint64_t key(const BrickPlace& at) noexcept;

 private:
  enum class State : std::uint8_t { None, Leaf, Split };
  [[nodiscard]] State state(const BrickPlace& at) const;
  void mark_parents_split(BrickPlace at);
  void split_down_to(const Lattice& lattice, const BrickPlace& at);

  FlatMap<State> cells_;
  std::array<std::vector<IVec3>, kMaxLevels + 1> split_;  ///< Up to the coarsest level of a leaf.
};

}  // namespace outcrop::meshing

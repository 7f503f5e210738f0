/// Cells and cubes of the sampler: where samples are near a point, and where there may be room for more.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "outcrop/core/vec.h"

namespace outcrop {

/// One point at most in each cell of a grid. Cells are kept in blocks of 4³; a block's occupied cells are the bits of a
/// word, so that empty cells are never looked at.
class CellGrid {
 public:
  static constexpr int kReach = 2;  ///< Cells to either side that visit_around looks at.

  /// @param count  Cells along each axis.
  explicit CellGrid(int count)
      : blocks_(count / 4 + 1),
        occupied_(static_cast<std::size_t>(blocks_) * blocks_ * blocks_, 0),
        point_in_(64 * occupied_.size()) {}

  void insert(const IVec3& cell, const Vec3& p) {
    const std::size_t b = block(cell >> 2);
    const auto bit = static_cast<std::size_t>((cell.z & 3) << 4 | (cell.y & 3) << 2 | (cell.x & 3));
    occupied_[b] |= std::uint64_t{1} << bit;
    point_in_[64 * b + bit] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
  }

  /// Calls `visit(cell, point)` for all points, block by block.
  template <class F>
  void visit(F&& visit) const {
    std::size_t b = 0;
    for (int z = 0; z < blocks_; ++z)
      for (int y = 0; y < blocks_; ++y)
        for (int x = 0; x < blocks_; ++x, ++b)
          for (std::uint64_t bits = occupied_[b]; bits != 0; bits &= bits - 1) {
            const int bit = std::countr_zero(bits);
            visit(4 * IVec3(x, y, z) + IVec3(bit & 3, bit >> 2 & 3, bit >> 4),
                  points_[point_in_[64 * b + static_cast<std::size_t>(bit)]]);
          }
  }

  /// Calls `visit(point)` for the points in the 5³ cells around a cell, until it returns false; then it does, too.
  /// @param cell  At least kReach cells from the border.
  template <class F>
  bool visit_around(const IVec3& cell, F&& visit) const {
    const IVec3 first = cell - kReach;
    const IVec3 at = first & 3;
    for (int corner = 0; corner < 8; ++corner) {  // five cells lie in two blocks
      const IVec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
      const std::size_t b = block((first >> 2) + step);
      const std::uint64_t window = kWindow[0][step.x][at.x] & kWindow[1][step.y][at.y] & kWindow[2][step.z][at.z];
      for (std::uint64_t bits = occupied_[b] & window; bits != 0; bits &= bits - 1)
        if (!visit(points_[point_in_[64 * b + static_cast<std::size_t>(std::countr_zero(bits))]])) return false;
    }
    return true;
  }

 private:
  /// [axis][block][at]: the cells of the first and the second block among the five from `at` on.
  static constexpr auto kWindow = [] {
    std::array<std::array<std::array<std::uint64_t, 4>, 2>, 3> window{};
    for (int axis = 0; axis < 3; ++axis)
      for (int at = 0; at < 4; ++at)
        for (int bit = 0; bit < 64; ++bit) {
          const int c = bit >> 2 * axis & 3;
          if (c >= at) window[axis][0][at] |= std::uint64_t{1} << bit;
          if (c <= at) window[axis][1][at] |= std::uint64_t{1} << bit;
        }
    return window;
  }();

  [[nodiscard]] std::size_t block(const IVec3& b) const {
    return (static_cast<std::size_t>(b.z) * blocks_ + b.y) * blocks_ + b.x;
  }

  int blocks_;
  std::vector<std::uint64_t> occupied_;
  std::vector<std::uint32_t> point_in_;
  std::vector<Vec3> points_;
};

/// A set of cubes of a grid: a bit each, 64 along x in a word.
class CubeSet {
 public:
  /// @param count  Cubes along each axis.
  explicit CubeSet(int count)
      : count_(count), words_(count / 64 + 1), bits_(static_cast<std::size_t>(count) * count * words_, 0) {}

  void insert(const IVec3& cube) { bits_[word(cube)] |= std::uint64_t{1} << (cube.x & 63); }

  /// Takes out the cubes of `mask`, seven from `first` on along x. None of them may lie outside the grid.
  void erase(const IVec3& first, std::uint64_t mask) {
    const std::size_t w = word(first);
    const int shift = first.x & 63;
    bits_[w] &= ~(mask << shift);
    if (shift > 64 - 7) bits_[w + 1] &= ~(mask >> (64 - shift));
  }

  /// Calls `visit(cube)` in order for those of the set for whose words `choose()` has the bit; `visit` may take out
  /// some.
  template <class Choose, class F>
  void visit(Choose&& choose, F&& visit) const {
    std::size_t w = 0;
    for (int z = 0; z < count_; ++z)
      for (int y = 0; y < count_; ++y)
        for (int x = 0; x < 64 * words_; x += 64, ++w) {
          if (bits_[w] == 0) continue;
          const std::uint64_t chosen = choose();
          for (std::uint64_t bits = bits_[w] & chosen; bits != 0; bits = bits & (bits - 1) & bits_[w])
            visit(IVec3(x + std::countr_zero(bits), y, z));
        }
  }

 private:
  [[nodiscard]] std::size_t word(const IVec3& cube) const {
    return (static_cast<std::size_t>(cube.z) * count_ + cube.y) * words_ + (cube.x >> 6);
  }

  int count_;
  int words_;  // In a row.
  std::vector<std::uint64_t> bits_;
};

}  // namespace outcrop

/// Buckets of points on the torus, for finding near ones.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "outcrop/core/vec.h"

namespace outcrop {

/// Points of [0, side)³ in cubic cells of at least `reach` metres: whatever lies within `reach` is in the 27 cells
/// around.
class WrappedGrid {
 public:
  WrappedGrid(double side, double reach)
      : count_(std::clamp(static_cast<int>(side / reach), 1, kMaxCells)),
        scale_(count_ / side),
        head_(static_cast<std::size_t>(count_) * count_ * count_, -1) {}

  /// The point gets the next index, from 0.
  void insert(const Vec3& p) {
    const std::size_t c = index(cell(p.x), cell(p.y), cell(p.z));
    next_.push_back(head_[c]);
    head_[c] = static_cast<std::int32_t>(next_.size()) - 1;
  }

  /// Calls `visit(i)` once for every point in the cells around p; farther ones than `reach` among them.
  template <class F>
  void visit_near(const Vec3& p, F&& visit) const {
    const std::array<int, 3> c{cell(p.x), cell(p.y), cell(p.z)};
    const int span = std::min(3, count_);  // fewer than three cells an axis: each of them once
    for (int dz = 0; dz < span; ++dz)
      for (int dy = 0; dy < span; ++dy)
        for (int dx = 0; dx < span; ++dx)
          for (std::int32_t i = head_[index(wrap(c[0] + dx - 1), wrap(c[1] + dy - 1), wrap(c[2] + dz - 1))]; i >= 0;
               i = next_[static_cast<std::size_t>(i)])
            visit(static_cast<std::uint32_t>(i));
  }

 private:
  static constexpr int kMaxCells = 256;  // 64 MB of heads at most

  [[nodiscard]] int cell(double v) const { return wrap(static_cast<int>(v * scale_)); }
  [[nodiscard]] int wrap(int i) const { return i < 0 ? i + count_ : i >= count_ ? i - count_ : i; }
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * count_ + y) * count_ + x;
  }

  int count_;
  double scale_;
  std::vector<std::int32_t> head_;
  std::vector<std::int32_t> next_;
};

}  // namespace outcrop

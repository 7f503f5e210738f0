/// Buckets of points on the torus, for finding near ones.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
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

/// The same for points that are all known: sorted by cell, for long runs through memory.
class SortedCells {
 public:
  struct Entry {
    Vec3 p;
    std::uint32_t index;
  };

  SortedCells(const std::vector<Vec3>& points, double side, double reach)
      : side_(side),
        count_(std::clamp(static_cast<int>(side / reach), 1, kMaxCells)),
        first_(static_cast<std::size_t>(count_) * count_ * count_ + 1, 0),
        entries_(points.size()) {
    for (const Vec3& p : points) ++first_[index(cell(p))];
    std::uint32_t sum = 0;  // the end of each cell, from where its points are put in backwards
    for (std::uint32_t& first : first_) first = sum += first;
    for (std::size_t i = points.size(); i-- > 0;)
      entries_[--first_[index(cell(points[i]))]] = {points[i], static_cast<std::uint32_t>(i)};
  }

  /// Calls `visit(entries, turn)` for runs of entries that hold all points within `reach` of p, of [0, side)³: those
  /// moved by `turn` may be near. All images of a point are met.
  template <class F>
  void visit_near(const Vec3& p, F&& visit) const {
    const IVec3 c = cell(p);
    for (int z = c.z - 1; z <= c.z + 1; ++z)
      for (int y = c.y - 1; y <= c.y + 1; ++y)
        for (int x = c.x - 1, end; x <= c.x + 1; x = end) {
          const IVec3 tile(turns(x), turns(y), turns(z));
          end = std::min(c.x + 2, count_ * (tile.x + 1));  // cells along x follow each other, up to the border
          const std::size_t from = index(IVec3(x, y, z) - count_ * tile);
          visit(std::span(entries_).subspan(first_[from], first_[from + (end - x)] - first_[from]), side_ * Vec3(tile));
        }
  }

 private:
  static constexpr int kMaxCells = 256;

  [[nodiscard]] IVec3 cell(const Vec3& p) const { return glm::min(IVec3(p * (count_ / side_)), IVec3(count_ - 1)); }
  [[nodiscard]] int turns(int c) const { return c < 0 ? -1 : c >= count_ ? 1 : 0; }
  [[nodiscard]] std::size_t index(const IVec3& c) const {
    return (static_cast<std::size_t>(c.z) * count_ + c.y) * count_ + c.x;
  }

  double side_;
  int count_;
  std::vector<std::uint32_t> first_;
  std::vector<Entry> entries_;
};

}  // namespace outcrop

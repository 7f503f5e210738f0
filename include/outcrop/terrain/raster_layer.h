/// A number for every place of a map: bilinear between the nodes of a raster, with bounds for any rectangle.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"
#include "outcrop/terrain/heightfield.h"

namespace outcrop {

/// What a bilinear Heightfield says, in an eighth of its memory: some 5.4 bytes a node, no missing data. Continued as a
/// constant beyond its border. 0 everywhere when default-constructed.
class RasterLayer {
 public:
  RasterLayer() = default;
  /// @param nodes  width · height finite numbers, rows from the south, each from the west; both sides ≥ 2.
  /// @param lo  Map position of the first node.  @param spacing  Of nodes, metres, > 0.
  RasterLayer(int width, int height, const Vec2& lo, double spacing, std::vector<float> nodes);

  [[nodiscard]] Heightfield::Sample at(double x, double y) const noexcept;
  /// samples[i] = at(x[i], y[i]), to the bit; positions that come back after a number of others are evaluated once.
  void at(std::span<const double> x, std::span<const double> y, std::span<Heightfield::Sample> samples) const noexcept;
  /// Contains all values over [lo, hi]. Cost: O(1).
  [[nodiscard]] Interval bound(const Vec2& lo, const Vec2& hi) const noexcept;
  /// ≥ the gradient's length over [lo, hi]; same cost.
  [[nodiscard]] double slope_bound(const Vec2& lo, const Vec2& hi) const noexcept;

  /// The rectangle of the nodes.
  [[nodiscard]] Vec2 lo() const noexcept;
  [[nodiscard]] Vec2 hi() const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;  ///< Copies are cheap.
};

}  // namespace outcrop

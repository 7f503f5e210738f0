#include "outcrop/terrain/raster_layer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "each_position.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "pyramid.h"

namespace outcrop {
namespace {

using terrain::PatchBound;
using terrain::Pyramid;

constexpr int kBlock = 4;                // Cells a side that share one bound.
constexpr double kRoundingSlack = 1e-6;  // Relative; bounds are floats.

}  // namespace

struct RasterLayer::Data {
  int width, height;
  Vec2 lo;
  double spacing;
  std::vector<float> nodes;
  Pyramid bounds;  ///< Of blocks of cells.

  [[nodiscard]] const float* node(int column, int row) const noexcept {
    return &nodes[static_cast<std::size_t>(row) * width + column];
  }

  /// The cell that holds a position, and the place in it; positions outside are moved to the border.
  struct Place {
    int column, row;
    double u, v;
  };
  [[nodiscard]] Place place(double x, double y) const noexcept {
    const double s = std::clamp((x - lo.x) / spacing, 0.0, static_cast<double>(width - 1));
    const double t = std::clamp((y - lo.y) / spacing, 0.0, static_cast<double>(height - 1));
    const int column = std::min(static_cast<int>(s), width - 2), row = std::min(static_cast<int>(t), height - 2);
    return {column, row, s - column, t - row};
  }

  [[nodiscard]] Heightfield::Sample at(double x, double y) const noexcept {
    const Place p = place(x, y);
    const float* const south = node(p.column, p.row);
    const float* const north = south + width;
    const double sw = south[0], se = south[1], nw = north[0], ne = north[1];
    const double on_south = sw + p.u * (se - sw), on_north = nw + p.u * (ne - nw);
    const Vec2 end = hi();
    const bool inside_x = x >= lo.x && x <= end.x, inside_y = y >= lo.y && y <= end.y;
    return {on_south + p.v * (on_north - on_south),
            inside_x ? ((se - sw) * (1.0 - p.v) + (ne - nw) * p.v) / spacing : 0.0,
            inside_y ? (on_north - on_south) / spacing : 0.0};
  }

  [[nodiscard]] Vec2 hi() const noexcept { return lo + spacing * Vec2(width - 1, height - 1); }

  [[nodiscard]] PatchBound block_bound(int block_column, int block_row) const noexcept {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    PatchBound bound{kInfinity, -kInfinity, 0.0f, 0.0f};
    const int last_column = std::min((block_column + 1) * kBlock, width - 1);
    const int last_row = std::min((block_row + 1) * kBlock, height - 1);
    for (int row = block_row * kBlock; row < last_row; ++row)
      for (int column = block_column * kBlock; column < last_column; ++column) {
        const float* const south = node(column, row);
        const float* const north = south + width;
        const float steepest_x = std::max(std::abs(south[1] - south[0]), std::abs(north[1] - north[0]));
        const float steepest_y = std::max(std::abs(north[0] - south[0]), std::abs(north[1] - south[1]));
        bound.lo = std::min({bound.lo, south[0], south[1], north[0], north[1]});
        bound.hi = std::max({bound.hi, south[0], south[1], north[0], north[1]});
        // Along each axis the derivative lies between those on two of the cell's sides.
        const double slope = std::hypot(double{steepest_x}, double{steepest_y}) / spacing;
        bound.slope = std::max(bound.slope, static_cast<float>(slope * (1.0 + kRoundingSlack)));
      }
    return bound;
  }

  [[nodiscard]] PatchBound over(const Vec2& a, const Vec2& b) const noexcept {
    const Place first = place(a.x, a.y), last = place(b.x, b.y);
    return bounds.bound(first.column / kBlock, last.column / kBlock, first.row / kBlock, last.row / kBlock);
  }
};

RasterLayer::RasterLayer(int width, int height, const Vec2& lo, double spacing, std::vector<float> nodes) {
  require(width >= 2 && height >= 2, "width and height", "2 or more nodes", std::min(width, height));
  require(nodes.size() == static_cast<std::size_t>(width) * height, "nodes", "width x height", static_cast<double>(nodes.size()));
  require(spacing > 0.0, "spacing", "> 0 m", spacing);
  auto data = std::make_shared<Data>(Data{width, height, lo, spacing, std::move(nodes), {}});
  const int columns = (width - 2) / kBlock + 1, rows = (height - 2) / kBlock + 1;
  std::vector<PatchBound> blocks(static_cast<std::size_t>(columns) * rows);
  parallel_for(static_cast<std::size_t>(rows), [&](std::size_t row) {
    for (int column = 0; column < columns; ++column)
      blocks[row * columns + column] = data->block_bound(column, static_cast<int>(row));
  });
  data->bounds = Pyramid(columns, rows, std::move(blocks));
  data_ = std::move(data);
}

Heightfield::Sample RasterLayer::at(double x, double y) const noexcept {
  return data_ ? data_->at(x, y) : Heightfield::Sample{0.0, 0.0, 0.0};
}

void RasterLayer::at(std::span<const double> x, std::span<const double> y,
                     std::span<Heightfield::Sample> samples) const noexcept {
  terrain::each_position(x, y, samples, [this](double at_x, double at_y) { return at(at_x, at_y); });
}

Interval RasterLayer::bound(const Vec2& a, const Vec2& b) const noexcept {
  if (!data_) return {0.0, 0.0};
  const PatchBound blocks = data_->over(a, b);
  // Boxes smaller than a block: the cone over the centre. Beyond the border nothing changes, so the slope still holds.
  const Vec2 centre = 0.5 * (a + b);
  const double reach = blocks.slope * glm::length(b - centre) * (1.0 + kRoundingSlack) + kRoundingSlack * std::abs(blocks.hi);
  const double h = data_->at(centre.x, centre.y).h;
  return {std::max(double{blocks.lo}, h - reach), std::min(double{blocks.hi}, h + reach)};
}

double RasterLayer::slope_bound(const Vec2& a, const Vec2& b) const noexcept { return data_ ? data_->over(a, b).slope : 0.0; }

Vec2 RasterLayer::lo() const noexcept { return data_ ? data_->lo : Vec2(0.0); }
Vec2 RasterLayer::hi() const noexcept { return data_ ? data_->hi() : Vec2(0.0); }

}  // namespace outcrop

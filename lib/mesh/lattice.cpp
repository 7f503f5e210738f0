#include "lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "outcrop/core/error.h"

namespace outcrop::meshing {
namespace {

/// A size that is whole cells but for rounding gets no extra cell.
constexpr double kRounding = 1e-6;
constexpr std::size_t kNodes = kBrickNodes * kBrickNodes * kBrickNodes;

bool may_hold_surface(const Field& field, const Box& box) {
  const Interval range = field.bound(box);
  return range.lo < 0.0 && range.hi >= 0.0;  // f = 0 is air.
}

}  // namespace

Lattice Lattice::over(const PolygonizeOptions& options) {
  const Box& region = options.region;
  require(std::isfinite(options.resolution) && options.resolution > 0.0, "resolution", "a number of metres > 0",
          options.resolution);
  Lattice lattice{.lo = region.lo, .step = options.resolution};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = std::string("region.") + "xyz"[axis];
    require(std::isfinite(region.lo[axis]), name, "a finite lower end", region.lo[axis]);
    require(std::isfinite(region.hi[axis]), name, "a finite upper end", region.hi[axis]);
    const double size = region.hi[axis] - region.lo[axis];
    require(size > 0.0, name, "an extent > 0", size);
    const double cells = std::ceil(size / options.resolution - kRounding);
    if (cells > kMaxCells) {
      char bound[96];
      std::snprintf(bound, sizeof bound, "at least %.3g m for %d cells along %c", size / kMaxCells, kMaxCells,
                    "xyz"[axis]);
      require(false, "resolution", bound, options.resolution);
    }
    lattice.cells[axis] = std::max(1, static_cast<int>(cells));
  }
  return lattice;
}

Box Lattice::box(const IVec3& index, int level) const noexcept {
  const int span = kBrickCells << level;
  return {node(index * span), node(glm::min((index + 1) * span, cells))};
}

int root_level(const Lattice& lattice) noexcept {
  const IVec3 bricks = lattice.bricks();
  const int longest = std::max({bricks.x, bricks.y, bricks.z});
  return std::bit_width(static_cast<unsigned>(longest - 1));
}

std::vector<Cell> root_cells(const Lattice& lattice, const Field& field) {
  const Box box = lattice.box(IVec3(0), root_level(lattice));
  if (!may_hold_surface(field, box)) return {};
  return {{IVec3(0), field.narrow(box)}};
}

std::vector<Cell> split(const Lattice& lattice, const Cell& cell, int level) {
  std::vector<Cell> children;
  const FieldPtr field = cell.field->narrow(lattice.box(cell.index, level));
  const int span = kBrickCells << (level - 1);
  for (int octant = 0; octant < 8; ++octant) {
    const IVec3 index = 2 * cell.index + IVec3(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
    if (index.x * span >= lattice.cells.x || index.y * span >= lattice.cells.y || index.z * span >= lattice.cells.z)
      continue;
    if (may_hold_surface(*field, lattice.box(index, level - 1))) children.push_back({index, field});
  }
  return children;
}

Brick::Brick(const Lattice& lattice, const IVec3& brick_index) : index(brick_index) {
  for (int axis = 0; axis < 3; ++axis) {
    const int rest = lattice.cells[axis] - index[axis] * kBrickCells;
    cells[axis] = std::min(rest, kBrickCells);
    owned[axis] = rest <= kBrickCells ? cells[axis] + 1 : kBrickCells;
  }
}

BrickValues::BrickValues() : x_(kNodes), y_(kNodes), z_(kNodes), values_(kNodes) {}

bool BrickValues::sample(const Lattice& lattice, const Field& field, Brick& brick) {
  const IVec3 first = brick.index * kBrickCells;
  std::array<double, kBrickNodes> row_x;
  for (int i = 0; i < kBrickNodes; ++i) row_x[i] = lattice.coordinate(0, first.x + i);
  const int width = brick.cells.x + 1;
  std::size_t n = 0;
  for (int k = 0; k <= brick.cells.z; ++k) {
    const double z = lattice.coordinate(2, first.z + k);
    for (int j = 0; j <= brick.cells.y; ++j, n += width) {
      std::copy_n(row_x.begin(), width, x_.begin() + n);
      std::fill_n(y_.begin() + n, width, lattice.coordinate(1, first.y + j));
      std::fill_n(z_.begin() + n, width, z);
    }
  }
  const std::span<double> values = std::span(values_).first(n);
  field.values({std::span(x_).first(n), std::span(y_).first(n), std::span(z_).first(n)}, values, {});

  // Spread the rows of a brick cut short to their places, last row first so that none is overwritten unread.
  unsigned any = 0, all = ~0u;
  for (int k = brick.cells.z; k >= 0; --k) {
    for (int j = brick.cells.y; j >= 0; --j) {
      const double* from = &values_[(k * (brick.cells.y + 1) + j) * width];
      double* to = &values_[(k * 9 + j) * 9];
      unsigned bits = 0;
      for (int i = width - 1; i >= 0; --i) {
        to[i] = from[i];
        bits = bits << 1 | (to[i] < 0.0 ? 1u : 0u);
      }
      brick.rock[k * 9 + j] = static_cast<std::uint16_t>(bits);
      any |= bits;
      all &= bits;
    }
  }
  return any != 0 && all != (1u << width) - 1;
}

}  // namespace outcrop::meshing

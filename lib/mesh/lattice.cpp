#include "lattice.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <string>

#include "outcrop/core/error.h"
#include "outcrop/core/simd.h"

namespace outcrop::meshing {
namespace {

/// A size that is whole cells but for rounding gets no extra cell.
constexpr double kRounding = 1e-6;
/// Levels are limited so that rounding the number of cells up to whole coarsest ones costs at most this share of a
/// cell's edge, and so that at least so many coarsest cells lie along the shorter side.
constexpr double kMostShrinking = 1.0 / 16.0;
constexpr int kCoarsestAlong = 12;

int rounded_up(int cells, int level) { return (((cells - 1) >> level) + 1) << level; }

int coarsest_level(const PolygonizeOptions& options, const IVec3& cells) {
  require(std::isfinite(options.tolerance) && options.tolerance >= 0.0, "tolerance", "a number of metres >= 0",
          options.tolerance);
  require(options.levels >= 0 && options.levels <= kMaxLevels, "levels", "0 to 8", options.levels);
  if (options.tolerance == 0.0) return 0;
  const auto fits = [&](int along, int level) {
    const int whole = rounded_up(along, level);
    return whole >> level >= kCoarsestAlong && whole - along <= kMostShrinking * whole;
  };
  int level = options.levels;
  while (level > 0 && !(fits(cells.x, level) && fits(cells.y, level))) --level;
  return level;
}

/// flags[n] = 1 where values[n] < 0, of 9³.
OUTCROP_SIMD_CLONES
void mark_negative(const double* __restrict values, std::uint8_t* __restrict flags) {
  for (int n = 0; n < kNodes; ++n) flags[n] = values[n] < 0.0 ? 1 : 0;
}

/// The nodes that the brick twice as large around a brick does not have.
constexpr int kNodesBetween = kNodes - (kBrickCells / 2 + 1) * (kBrickCells / 2 + 1) * (kBrickCells / 2 + 1);
constexpr auto kBetween = [] {
  std::array<std::uint16_t, kNodesBetween> nodes{};
  for (int node = 0, n = 0; node < kNodes; ++node)
    if (node % 9 % 2 + node / 9 % 9 % 2 + node / 81 % 2 > 0) nodes[n++] = static_cast<std::uint16_t>(node);
  return nodes;
}();

}  // namespace

bool may_hold_surface(const Field& field, const Box& box) { return may_change_sign(field.bound(box)); }

double clear_value(const Field& field, double distance) noexcept {
  constexpr double kRoundedUp = 1.0 + 1e-6;
  const Modulus modulus = field.modulus();
  return kRoundedUp * std::min(field.lipschitz() * distance, modulus.slope * distance + modulus.slack);
}

Lattice Lattice::over(const PolygonizeOptions& options) {
  const Box& region = options.region;
  require(std::isfinite(options.resolution) && options.resolution > 0.0, "resolution", "a number of metres > 0",
          options.resolution);
  Lattice lattice{.lo = region.lo, .step = Vec3(options.resolution), .origin = options.origin.value_or(region.lo)};
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
    const double from_origin = std::max(region.hi[axis] - lattice.origin[axis], lattice.origin[axis] - region.lo[axis]);
    require(from_origin / options.resolution <= kMaxCells + kRounding, "origin",
            "at most 131072 cells from the region's far side", from_origin / options.resolution);
  }
  lattice.coarsest = coarsest_level(options, lattice.cells);
  if (lattice.coarsest == 0) return lattice;
  for (int axis = 0; axis < 3; ++axis) {
    lattice.cells[axis] = rounded_up(lattice.cells[axis], lattice.coarsest);
    // Sideways the mesh ends where it was asked to end; upwards there is room.
    if (axis < 2) lattice.step[axis] = (region.hi[axis] - region.lo[axis]) / lattice.cells[axis];
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

std::vector<Cell> children(const Lattice& lattice, const IVec3& index, int level, const FieldPtr& narrowed) {
  std::vector<Cell> cells;
  for (int octant = 0; octant < 8; ++octant) {
    const IVec3 child = child_index(index, octant);
    if (lattice.holds(child, level - 1) && may_hold_surface(*narrowed, lattice.box(child, level - 1)))
      cells.push_back({child, narrowed});
  }
  return cells;
}

std::vector<Cell> split(const Lattice& lattice, const Cell& cell, int level) {
  return children(lattice, cell.index, level, cell.field->narrow(lattice.box(cell.index, level)));
}

BrickShape::BrickShape(const IVec3& size) noexcept {
  for (int node = 0; node < kNodes; ++node) {
    const IVec3 p = node_place(node);
    if (p.x > size.x || p.y > size.y || p.z > size.z) continue;
    nodes.insert(node);
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] < size[axis]) edges[axis].insert(node);
    if (p.x < size.x && p.y < size.y && p.z < size.z) cells.insert(node);
  }
}

const BrickShape& BrickShape::whole() noexcept {
  static const BrickShape shape{IVec3(kBrickCells)};
  return shape;
}

Brick::Brick(const Lattice& lattice, const IVec3& brick_index, int brick_level)
    : index(brick_index),
      level(brick_level),
      cells(glm::min((lattice.cells - first()) / (1 << level), IVec3(kBrickCells))),
      shape(cells == IVec3(kBrickCells) ? BrickShape::whole() : BrickShape(cells)) {}

BrickValues::BrickValues() : x_(kNodes), y_(kNodes), z_(kNodes), values_(kNodes) {}

bool BrickValues::sample(const Lattice& lattice, const Field& field, Brick& brick, std::span<const double> parent) {
  if (!parent.empty() && brick.cells == IVec3(kBrickCells)) return sample_between(lattice, field, brick, parent);
  const IVec3 first = brick.first();
  const int stride = 1 << brick.level;
  std::array<double, kBrickNodes> row_x;
  for (int i = 0; i < kBrickNodes; ++i) row_x[i] = lattice.coordinate(0, first.x + i * stride);
  const int width = brick.cells.x + 1;
  std::size_t n = 0;
  for (int k = 0; k <= brick.cells.z; ++k) {
    const double z = lattice.coordinate(2, first.z + k * stride);
    for (int j = 0; j <= brick.cells.y; ++j, n += width) {
      std::copy_n(row_x.begin(), width, x_.begin() + n);
      std::fill_n(y_.begin() + n, width, lattice.coordinate(1, first.y + j * stride));
      std::fill_n(z_.begin() + n, width, z);
    }
  }
  const std::span<double> values = std::span(values_).first(n);
  evaluations_ = n;
  field.values({std::span(x_).first(n), std::span(y_).first(n), std::span(z_).first(n)}, values, {});

  // Spread the rows of a brick cut short to their places, last row first so that none is overwritten unread.
  for (int k = brick.cells.z; k >= 0 && n < kNodes; --k)
    for (int j = brick.cells.y; j >= 0; --j) {
      const double* from = &values_[(k * (brick.cells.y + 1) + j) * width];
      std::copy_backward(from, from + width, &values_[(k * 9 + j) * 9] + width);
    }
  return classify(brick);
}

bool BrickValues::sample_between(const Lattice& lattice, const Field& field, Brick& brick,
                                 std::span<const double> parent) {
  const IVec3 first = brick.first();
  std::array<std::array<double, kBrickNodes>, 3> at;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kBrickNodes; ++i) at[axis][i] = lattice.coordinate(axis, first[axis] + (i << brick.level));
  for (int n = 0; n < kNodesBetween; ++n) {
    const IVec3 place = node_place(kBetween[n]);
    x_[n] = at[0][place.x];
    y_[n] = at[1][place.y];
    z_[n] = at[2][place.z];
  }
  std::array<double, kNodesBetween> values;
  evaluations_ = values.size();
  field.values(Points{x_, y_, z_}.subspan(0, values.size()), values, {});
  for (int n = 0; n < kNodesBetween; ++n) values_[kBetween[n]] = values[n];
  constexpr int kHalf = kBrickCells / 2;
  const IVec3 octant = kHalf * (brick.index & 1);
  const double* const known = &parent[octant.x + octant.y * kStride[1] + octant.z * kStride[2]];
  for (int k = 0; k <= kHalf; ++k)
    for (int j = 0; j <= kHalf; ++j)
      for (int i = 0; i <= kHalf; ++i)
        values_[2 * (i + j * kStride[1] + k * kStride[2])] = known[i + j * kStride[1] + k * kStride[2]];
  return classify(brick);
}

bool BrickValues::use(const std::vector<double>& values, Brick& brick) {
  values_ = values;
  return classify(brick);
}

bool BrickValues::classify(Brick& brick) const {
  std::array<std::uint8_t, NodeSet::kWords * 64> negative;
  mark_negative(values_.data(), negative.data());
  std::fill(negative.begin() + kNodes, negative.end(), 0);
  brick.rock = NodeSet::of(negative.data()) & brick.shape.nodes;
  return !brick.rock.empty() && brick.rock != brick.shape.nodes;
}

}  // namespace outcrop::meshing

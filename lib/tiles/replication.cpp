#include "outcrop/tiles/replication.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/vector_relational.hpp>

#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "outcrop/implicit/polytope_union.h"

namespace outcrop {
namespace {

constexpr std::size_t kChunk = 256;      // Points handled at a time by narrowed nodes.
constexpr std::size_t kWorthAList = 200; // Boxes with more candidate blocks are not narrowed: their children will be.
constexpr double kWorthAsking = 300.0;   // Boxes that may touch more blocks than this are not looked at block by block.
constexpr double kFloatSlack = 2e-5;     // Metres; rounding of a block's float coordinates, some 10 m at 24 bits.

int floor_div(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

std::uint64_t cell_key(const IVec3& cell) {
  constexpr std::uint64_t kMask = (1ull << 21) - 1;
  return (static_cast<std::uint64_t>(cell.x) & kMask) | ((static_cast<std::uint64_t>(cell.y) & kMask) << 21) |
         ((static_cast<std::uint64_t>(cell.z) & kMask) << 42);
}

IVec3 cell_of(const Vec3& p, double side) { return IVec3(glm::floor(p / side)); }

/// The box that holds a box after a rotation.
Box rotated(const Mat3& rotation, const Box& box) {
  const Vec3 centre = rotation * box.centre();
  const Vec3 half = 0.5 * box.size();
  Vec3 reach{0.0};
  for (int column = 0; column < 3; ++column) reach += glm::abs(rotation[column]) * half[column];
  return {centre - reach, centre + reach};
}

/// Where a polytope with an inner ball of radius r about its centre may have values below t > 0.
///
/// Every plane has offset d ≤ −r, so n · x + d ≤ t gives n · x ≤ −d + t ≤ −d (1 + t / r): x lies in the polytope scaled
/// by 1 + t / r, and its box in the box scaled alike.
Box support_box(const Box& bounds, double inradius, double t) {
  const double scale = 1.0 + t / inradius;
  return {bounds.lo * scale, bounds.hi * scale};
}

Box relative(const Box& box, const Vec3& position) { return box.moved(-position).grown(kFloatSlack); }

}  // namespace

/// What a Replication narrows to: an explicit list of blocks.
class PlacedBlocks final : public Field {
 public:
  using Item = PlacedKernel;  ///< Position in the tile frame, without wrapping.

  /// @param growth  Of all blocks, where there is no crack floor to ask.
  PlacedBlocks(std::shared_ptr<const Replication> root, FieldPtr crack_floor, double growth, std::vector<Item> items)
      : root_(std::move(root)), crack_floor_(std::move(crack_floor)), growth_(growth), items_(std::move(items)) {
    for (const Item& item : items_) lipschitz_ = std::max(lipschitz_, item.kernel.lipschitz());
    if (crack_floor_ && !items_.empty()) lipschitz_ += root_->options_.closure_slope * crack_floor_->lipschitz();
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t count = std::min(kChunk, points.size() - first);
      chunk(points.subspan(first, count), values.subspan(first, count),
            gradients.empty() ? gradients : gradients.subspan(first, count));
    }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Box tile_box = root_->to_tile(box);
    Interval result{root_->options_.cap, root_->options_.cap};
    if (items_.empty()) return result;
    const Interval growth = growth_bound(box);
    for (const Item& item : items_) result = outcrop::min(result, item_bound(item, tile_box, growth));
    return result;
  }

  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    if (items_.empty()) return shared_from_this();
    const Box tile_box = root_->to_tile(box);
    const Interval growth = growth_bound(box);
    std::vector<Interval> bounds;
    double smallest = root_->options_.cap;
    for (const Item& item : items_) {
      bounds.push_back(item_bound(item, tile_box, growth));
      smallest = std::min(smallest, bounds.back().hi);
    }
    std::vector<Item> kept;
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (bounds[i].lo <= smallest)
        kept.push_back({items_[i].kernel.narrow(relative(tile_box, items_[i].position)), items_[i].position});
    // Above the floor nothing grows, far below everything does by `closure`: then nobody asks the floor.
    const bool asks = crack_floor_ && !kept.empty() && growth.lo < growth.hi;
    return std::make_shared<PlacedBlocks>(root_, asks ? crack_floor_->narrow(box) : nullptr, growth.lo, std::move(kept));
  }

  void labels(const Points& points, std::span<Label> labels) const noexcept override { root_->labels(points, labels); }

 private:
  [[nodiscard]] Interval growth_bound(const Box& box) const noexcept {
    if (!crack_floor_) return {growth_, growth_};
    const Interval floor = crack_floor_->bound(box);
    const ReplicationOptions& o = root_->options_;
    return {std::clamp(-o.closure_slope * floor.hi, 0.0, o.closure), std::clamp(-o.closure_slope * floor.lo, 0.0, o.closure)};
  }

  [[nodiscard]] Interval item_bound(const Item& item, const Box& tile_box, const Interval& growth) const noexcept {
    const Interval b = item.kernel.bound(relative(tile_box, item.position));
    const double swelling = root_->options_.swelling;
    return {b.lo - swelling - growth.hi, b.hi - swelling - growth.lo};
  }

  void chunk(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
    const ReplicationOptions& o = root_->options_;
    const std::size_t n = points.size();
    const bool wants_gradients = !gradients.empty();
    std::ranges::fill(values, o.cap);
    std::ranges::fill(gradients, Vec3(0.0));
    if (items_.empty()) return;

    std::array<double, kChunk> x, y, z, growth;
    std::array<Vec3, kChunk> growth_gradients;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 p = root_->to_tile(points[i]);
      x[i] = p.x, y[i] = p.y, z[i] = p.z;
    }
    if (!crack_floor_) {
      std::fill_n(growth.begin(), n, o.swelling + growth_);
    } else {
      crack_floor_->values(points, {growth.data(), n},
                           wants_gradients ? std::span(growth_gradients).first(n) : std::span<Vec3>{});
      for (std::size_t i = 0; i < n; ++i) {
        const double raw = -o.closure_slope * growth[i];
        growth[i] = o.swelling + std::clamp(raw, 0.0, o.closure);
        if (wants_gradients) growth_gradients[i] *= raw > 0.0 && raw < o.closure ? -o.closure_slope : 0.0;
      }
    }
    lower_to_union(items_, {{x.data(), n}, {y.data(), n}, {z.data(), n}}, std::span(growth).first(n), values,
                   gradients);
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      if (values[i] == o.cap) continue;
      gradients[i] = root_->rock_.world_from_tile * gradients[i];
      if (crack_floor_) gradients[i] -= growth_gradients[i];
    }
  }

  std::shared_ptr<const Replication> root_;
  FieldPtr crack_floor_;
  double growth_;
  std::vector<Item> items_;
  double lipschitz_ = 1.0;
};

Replication::Replication(Rock rock, FieldPtr terrain, ReplicationOptions options, const Task& task)
    : rock_(std::move(rock)), options_(std::move(options)), tile_from_world_(glm::transpose(rock_.world_from_tile)) {
  require(options_.cap > 0.0, "cap", "> 0 m", options_.cap);
  require(options_.closure >= 0.0, "closure", ">= 0 m", options_.closure);
  require(options_.closure_slope > 0.0, "closure_slope", "> 0", options_.closure_slope);
  require(options_.swelling >= 0.0, "swelling", ">= 0 m", options_.swelling);
  require(!options_.domain.empty(), "domain", "a box that is not empty", "an empty one");
  if (options_.closure == 0.0) options_.crack_floor = nullptr;

  const double reach = options_.cap + options_.swelling + options_.closure + kFloatSlack;
  for (const Block& block : rock_.tile.blocks) {
    PolytopeKernel kernel(block.planes, block.rounding, rock_.warp, block.centre);
    lipschitz_ = std::max(lipschitz_, kernel.lipschitz());
    // The centre's smallest plane distance, not the reported ball: the proof of support_box needs exactly that.
    double inner = std::numeric_limits<double>::infinity();
    for (const Plane& plane : block.planes) inner = std::min(inner, -plane.offset);
    shapes_.push_back({.kernel = std::move(kernel),
                       .centre = block.centre,
                       .support = support_box(block.bounds, std::max(inner, 1e-3), reach),
                       .world = rotated(rock_.world_from_tile, block.bounds),
                       .inradius = block.inradius});
  }
  // A block is 1-Lipschitz before its warp, which only adds: no value lies deeper than half of its smallest extent.
  for (const Shape& shape : shapes_) supports_ = hull(supports_, shape.support);
  for (const Block& block : rock_.tile.blocks) {
    const Vec3 size = block.bounds.size();
    deepest_ = std::max(deepest_, 0.5 * std::min({size.x, size.y, size.z}));
  }
  deepest_ += options_.swelling + options_.closure;
  if (options_.crack_floor) lipschitz_ += options_.closure_slope * options_.crack_floor->lipschitz();
  bake_lists();
  place_blocks(*terrain, task);
}

Box Replication::to_tile(const Box& world) const noexcept {
  return rotated(tile_from_world_, world.moved(-rock_.origin)).grown(1e-9);
}

void Replication::bake_lists() {
  voxels_ = std::clamp(static_cast<int>(std::lround(3.0 * std::cbrt(static_cast<double>(shapes_.size())))), 2, 32);
  const double voxel = rock_.tile.side / voxels_;
  std::vector<std::vector<Entry>> lists(static_cast<std::size_t>(voxels_) * voxels_ * voxels_);
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const Box box = shapes_[i].support.moved(shapes_[i].centre);
    const IVec3 lo(glm::floor(box.lo / voxel));
    const IVec3 hi(glm::floor(box.hi / voxel));
    for (int z = lo.z; z <= hi.z; ++z)
      for (int y = lo.y; y <= hi.y; ++y)
        for (int x = lo.x; x <= hi.x; ++x) {
          // Voxel (x, y, z) of the owner's frame lies in cell owner + q; seen from there the owner is at −q.
          const IVec3 q(floor_div(x, voxels_), floor_div(y, voxels_), floor_div(z, voxels_));
          const IVec3 v = IVec3(x, y, z) - q * voxels_;
          lists[(static_cast<std::size_t>(v.z) * voxels_ + v.y) * voxels_ + v.x].push_back(
              {static_cast<std::uint32_t>(i), static_cast<std::int8_t>(-q.x), static_cast<std::int8_t>(-q.y),
               static_cast<std::int8_t>(-q.z)});
        }
  }
  first_.assign(1, 0);
  for (const std::vector<Entry>& list : lists) {
    entries_.insert(entries_.end(), list.begin(), list.end());
    first_.push_back(static_cast<std::uint32_t>(entries_.size()));
  }
}

void Replication::place_blocks(const Field& terrain, const Task& task) {
  const double side = rock_.tile.side;
  const Box domain = to_tile(options_.domain);
  // One more cell around, for blocks that reach into the domain from outside.
  const IVec3 lo = cell_of(domain.lo, side) - 1;
  const IVec3 hi = cell_of(domain.hi, side) + 1;
  std::vector<IVec3> cells;
  for (int z = lo.z; z <= hi.z; ++z)
    for (int y = lo.y; y <= hi.y; ++y)
      for (int x = lo.x; x <= hi.x; ++x) cells.emplace_back(x, y, z);
  require(std::max({std::abs(lo.x), std::abs(lo.y), std::abs(lo.z), hi.x, hi.y, hi.z}) < (1 << 20), "domain",
          "at most 2^20 tiles from the origin", options_.domain.hi.x);

  double reach = 0.0;
  for (const Shape& shape : shapes_)
    reach = std::max({reach, glm::length(shape.support.lo), glm::length(shape.support.hi)});
  task.begin("placing blocks", cells.size());
  const auto masks = parallel_map(
      cells.size(),
      [&](std::size_t i) {
        task.advance();
        const Vec3 corner = Vec3(cells[i]) * side;
        const Box box = rotated(rock_.world_from_tile, Box{corner, corner + side}).moved(rock_.origin).grown(reach);
        if (!box.overlaps(options_.domain) || (options_.visible && !options_.visible(box))) return std::vector<std::uint64_t>{};
        return present_blocks(cells[i], terrain);
      },
      task);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::size_t count = 0;
    for (const std::uint64_t word : masks[i]) count += static_cast<std::size_t>(__builtin_popcountll(word));
    if (count > 0) present_.emplace(cell_key(cells[i]), masks[i]);
    block_count_ += count;
  }
}

std::vector<std::uint64_t> Replication::present_blocks(const IVec3& cell, const Field& terrain) const {
  std::vector<std::uint64_t> mask((shapes_.size() + 63) / 64, 0);
  std::vector<double> x, y, z, values;
  std::vector<Vec3> gradients;
  std::vector<Label> labels;
  std::vector<Anchor> anchors;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const Block& block = rock_.tile.blocks[i];
    if (shapes_[i].inradius < options_.min_inradius) continue;
    const Vec3 centre = Vec3(cell) * rock_.tile.side + block.centre;
    const Vec3 world_centre = rock_.origin + rock_.world_from_tile * centre;
    const Box world = shapes_[i].world.moved(world_centre);
    if (!world.overlaps(options_.domain) || (options_.visible && !options_.visible(world))) continue;
    if (options_.criterion) {
      const std::size_t n = block.anchors.size();
      x.resize(n), y.resize(n), z.resize(n), values.resize(n), gradients.resize(n), labels.resize(n), anchors.resize(n);
      for (std::size_t k = 0; k < n; ++k) {
        const Vec3 p = world_centre + rock_.world_from_tile * block.anchors[k];
        x[k] = p.x, y[k] = p.y, z[k] = p.z;
      }
      const Points points{x, y, z};
      terrain.values(points, values, gradients);
      terrain.labels(points, labels);
      for (std::size_t k = 0; k < n; ++k) {
        const double length = std::max(glm::length(gradients[k]), 1e-6);
        const double slope = options_.slope ? options_.slope(points[k])
                                            : std::acos(std::clamp(gradients[k].z / length, -1.0, 1.0));
        anchors[k] = {points[k], values[k] / length, slope, labels[k]};
      }
      if (!present(options_.criterion, anchors)) continue;
    }
    mask[i / 64] |= 1ull << (i % 64);
  }
  return mask;
}

bool Replication::block_present(const IVec3& cell, std::size_t block) const noexcept {
  const auto found = present_.find(cell_key(cell));
  return found != present_.end() && ((found->second[block / 64] >> (block % 64)) & 1) != 0;
}

std::size_t Replication::tile_bytes() const noexcept {
  std::size_t bytes = entries_.size() * sizeof(Entry) + first_.size() * sizeof(std::uint32_t);
  for (const Shape& shape : shapes_) bytes += sizeof(Shape) + shape.kernel.plane_count() * 4 * sizeof(float);
  return bytes;
}

template <class Visit>
void Replication::visit_blocks(const Box& tile_box, Visit&& visit) const {
  const double side = rock_.tile.side;
  const double voxel = side / voxels_;
  // Owners of blocks whose supports can reach the box, with their masks looked up once.
  const IVec3 owner_lo(glm::floor((tile_box.lo - supports_.hi) / side));
  const IVec3 owner_hi(glm::floor((tile_box.hi - supports_.lo) / side));
  const IVec3 count = owner_hi - owner_lo + 1;
  const std::size_t owners = static_cast<std::size_t>(count.x) * count.y * count.z;
  const std::size_t words = (shapes_.size() + 63) / 64;
  std::vector<const std::vector<std::uint64_t>*> masks(owners, nullptr);
  bool any = false;
  for (std::size_t i = 0; i < owners; ++i) {
    const int n = static_cast<int>(i);
    const IVec3 owner = owner_lo + IVec3(n % count.x, n / count.x % count.y, n / (count.x * count.y));
    const auto found = present_.find(cell_key(owner));
    if (found != present_.end()) masks[i] = &found->second, any = true;
  }
  if (!any) return;

  std::vector<std::uint64_t> candidates(owners * words, 0);
  const IVec3 lo(glm::floor(tile_box.lo / voxel));
  const IVec3 hi(glm::floor(tile_box.hi / voxel));
  for (int z = lo.z; z <= hi.z; ++z)
    for (int y = lo.y; y <= hi.y; ++y)
      for (int x = lo.x; x <= hi.x; ++x) {
        const IVec3 cell(floor_div(x, voxels_), floor_div(y, voxels_), floor_div(z, voxels_));
        const IVec3 v = IVec3(x, y, z) - cell * voxels_;
        const std::size_t index = (static_cast<std::size_t>(v.z) * voxels_ + v.y) * voxels_ + v.x;
        for (std::uint32_t e = first_[index]; e < first_[index + 1]; ++e) {
          const Entry& entry = entries_[e];
          const IVec3 owner = cell + IVec3(entry.dx, entry.dy, entry.dz) - owner_lo;
          if (glm::any(glm::lessThan(owner, IVec3(0))) || glm::any(glm::greaterThanEqual(owner, count))) continue;
          const std::size_t o = (static_cast<std::size_t>(owner.z) * count.y + owner.y) * count.x + owner.x;
          candidates[o * words + entry.block / 64] |= 1ull << (entry.block % 64);
        }
      }
  for (std::size_t o = 0; o < owners; ++o) {
    if (!masks[o]) continue;
    const int n = static_cast<int>(o);
    const Vec3 corner = Vec3(owner_lo + IVec3(n % count.x, n / count.x % count.y, n / (count.x * count.y))) * side;
    for (std::size_t w = 0; w < words; ++w)
      for (std::uint64_t bits = candidates[o * words + w] & (*masks[o])[w]; bits != 0; bits &= bits - 1) {
        const auto block = static_cast<std::uint32_t>(64 * w + static_cast<std::size_t>(__builtin_ctzll(bits)));
        const Vec3 position = corner + shapes_[block].centre;
        if (shapes_[block].support.moved(position).overlaps(tile_box)) visit(block, position);
      }
  }
}

void Replication::values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  const double side = rock_.tile.side;
  const double voxel = side / voxels_;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = to_tile(points[i]);
    double best = options_.cap;
    Vec3 best_gradient(0.0);
    bool has_growth = false;
    double growth = options_.swelling;
    Vec3 growth_gradient(0.0);
    const IVec3 global(glm::floor(p / voxel));
    const IVec3 cell(floor_div(global.x, voxels_), floor_div(global.y, voxels_), floor_div(global.z, voxels_));
    const IVec3 v = global - cell * voxels_;
    const std::size_t index = (static_cast<std::size_t>(v.z) * voxels_ + v.y) * voxels_ + v.x;
    for (std::uint32_t e = first_[index]; e < first_[index + 1]; ++e) {
      const Entry& entry = entries_[e];
      const IVec3 owner = cell + IVec3(entry.dx, entry.dy, entry.dz);
      if (!block_present(owner, entry.block)) continue;
      const Shape& shape = shapes_[entry.block];
      const Vec3 local = p - (Vec3(owner) * side + shape.centre);
      if (!shape.support.contains(local)) continue;
      if (!has_growth && options_.crack_floor) {
        const double raw = -options_.closure_slope * options_.crack_floor->value(points[i]);
        growth = options_.swelling + std::clamp(raw, 0.0, options_.closure);
        if (!gradients.empty() && raw > 0.0 && raw < options_.closure)
          growth_gradient = -options_.closure_slope * options_.crack_floor->gradient(points[i]);
        has_growth = true;
      }
      const float x = static_cast<float>(local.x), y = static_cast<float>(local.y), z = static_cast<float>(local.z);
      float b = 0.0f;
      Vec3f g(0.0f);
      shape.kernel.values(1, &x, &y, &z, &b, gradients.empty() ? nullptr : &g);
      const double value = static_cast<double>(b) - growth;
      if (value >= best) continue;
      best = value;
      best_gradient = rock_.world_from_tile * Vec3(g) - growth_gradient;
    }
    values[i] = best;
    if (!gradients.empty()) gradients[i] = best_gradient;
  }
}

double Replication::lipschitz() const noexcept { return lipschitz_; }

double Replication::blocks_about(const Box& tile_box) const noexcept {
  const Vec3 reach = (tile_box.size() + 0.5 * supports_.size()) / rock_.tile.side;
  return reach.x * reach.y * reach.z * static_cast<double>(shapes_.size());
}

Interval Replication::growth_bound(const Box& box) const noexcept {
  if (!options_.crack_floor) return {0.0, 0.0};
  const Interval floor = options_.crack_floor->bound(box);
  return {std::clamp(-options_.closure_slope * floor.hi, 0.0, options_.closure),
          std::clamp(-options_.closure_slope * floor.lo, 0.0, options_.closure)};
}

Interval Replication::block_bound(const Shape& shape, const Vec3& position, const Box& tile_box,
                                  const Interval& growth) const noexcept {
  const Interval b = shape.kernel.bound(relative(tile_box, position));
  return {b.lo - options_.swelling - growth.hi, b.hi - options_.swelling - growth.lo};
}

Interval Replication::bound(const Box& box) const noexcept {
  const Box tile_box = to_tile(box);
  Interval result{options_.cap, options_.cap};
  if (blocks_about(tile_box) > kWorthAsking) return {-deepest_, options_.cap};
  const Interval growth = growth_bound(box);
  visit_blocks(tile_box, [&](std::uint32_t block, const Vec3& position) {
    result = outcrop::min(result, block_bound(shapes_[block], position, tile_box, growth));
  });
  return result;
}

FieldPtr Replication::narrow(const Box& box) const {
  const Box tile_box = to_tile(box);
  if (blocks_about(tile_box) > kWorthAsking) return shared_from_this();
  std::vector<PlacedBlocks::Item> items;
  visit_blocks(tile_box, [&](std::uint32_t block, const Vec3& position) { items.push_back({shapes_[block].kernel, position}); });
  if (items.size() > kWorthAList) return shared_from_this();
  const auto root = std::static_pointer_cast<const Replication>(shared_from_this());
  return std::make_shared<PlacedBlocks>(root, options_.crack_floor, 0.0, std::move(items))->narrow(box);
}

void Replication::labels(const Points&, std::span<Label> labels) const noexcept {
  std::ranges::fill(labels, rock_.label);
}

}  // namespace outcrop

#include "outcrop/tiles/replication.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/vector_relational.hpp>

#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "outcrop/implicit/polytope_union.h"

namespace outcrop {
namespace {

constexpr std::size_t kChunk = 768;      // Points handled at a time by narrowed nodes: a mesher's brick of 9³.
constexpr std::size_t kWorthAList = 600; // Boxes with more blocks are not narrowed: their children will be.
constexpr double kEdgeStep = 0.04;       // Of an edge, at least, on the way along it.
constexpr double kSplinter = 0.5;        // Of the least inner radius: how deep in its body a block must reach.
constexpr double kFloatSlack = 2e-5;     // Metres; rounding of a block's float coordinates, some 10 m at 24 bits.

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

}  // namespace

/// What a Replication narrows to: an explicit list of blocks. In large boxes they are the root's; in small ones each is
/// narrowed.
class PlacedBlocks final : public Field {
 public:
  struct Item {
    std::uint32_t block;
    Vec3 position;  ///< Of the block's centre, tile frame without wrapping.
  };

  /// @param growth  Of all blocks, where there is no crack floor to ask.
  PlacedBlocks(std::shared_ptr<const Replication> root, FieldPtr crack_floor, double growth, std::vector<Item> items,
               std::vector<PolytopeKernel> narrowed)
      : root_(std::move(root)),
        crack_floor_(std::move(crack_floor)),
        growth_(growth),
        items_(std::move(items)),
        narrowed_(std::move(narrowed)) {
    for (std::size_t k = 0; k < items_.size(); ++k) {
      const PolytopeKernel& kernel = narrowed_.empty() ? root_->shapes_[items_[k].block].kernel : narrowed_[k];
      placed_.push_back({&kernel, items_[k].position});
      lipschitz_ = std::max(lipschitz_, kernel.lipschitz());
    }
    if (crack_floor_ && !items_.empty()) lipschitz_ += root_->options_.closure_slope * crack_floor_->lipschitz();
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    std::ranges::fill(values, root_->options_.cap);
    std::ranges::fill(gradients, Vec3(0.0));
    between(points, {}, values, gradients);
  }

  void between(const Points& points, std::span<const double> floors, std::span<double> values,
               std::span<Vec3> gradients) const noexcept override {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] <= root_->options_.cap) continue;
      values[i] = root_->options_.cap;
      if (!gradients.empty()) gradients[i] = Vec3(0.0);
    }
    if (items_.empty()) {
      for (std::size_t i = 0; i < floors.size(); ++i) values[i] = std::max(floors[i], values[i]);
      return;
    }
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t count = std::min(kChunk, points.size() - first);
      chunk(points.subspan(first, count), floors.empty() ? floors : floors.subspan(first, count),
            values.subspan(first, count), gradients.empty() ? gradients : gradients.subspan(first, count));
    }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  [[nodiscard]] Modulus modulus() const noexcept override {
    const double growth = crack_floor_ ? root_->options_.closure_slope * crack_floor_->lipschitz() : 0.0;
    return {1.0 + growth, root_->rock_.warp.active() ? root_->rock_.warp.amplitude : 0.0};
  }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Box tile_box = root_->to_tile(box);
    const double cap = root_->options_.cap;
    Interval result{cap, cap};
    if (items_.empty()) return result;
    if (root_->large(box)) {
      const bool any = std::ranges::any_of(items_, [&](const Item& item) { return reaches(item, tile_box); });
      return any ? Interval{-root_->deepest_, cap} : result;
    }
    const Interval growth = growth_bound(box);
    const TurnedBox turned = root_->turned(box);
    for (std::size_t k = 0; k < items_.size(); ++k)
      if (reaches(items_[k], tile_box)) result = outcrop::min(result, bound_of(k, turned, growth));
    return result;
  }

  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    if (items_.empty()) return shared_from_this();
    const Box tile_box = root_->to_tile(box);
    std::vector<Item> kept;
    if (root_->large(box)) {
      std::ranges::copy_if(items_, std::back_inserter(kept), [&](const Item& i) { return reaches(i, tile_box); });
      return kept.size() == items_.size()
                 ? shared_from_this()
                 : std::make_shared<PlacedBlocks>(root_, crack_floor_, growth_, std::move(kept),
                                                    std::vector<PolytopeKernel>{});
    }
    const Interval growth = growth_bound(box);
    const TurnedBox turned = root_->turned(box);
    struct Candidate {
      std::size_t item;
      double lowest;
    };
    std::vector<Candidate> candidates;
    double smallest = root_->options_.cap;
    for (std::size_t k = 0; k < items_.size(); ++k) {
      if (!reaches(items_[k], tile_box)) continue;
      const Interval bound = bound_of(k, turned, growth);
      if (bound.lo > smallest) continue;
      candidates.push_back({k, bound.lo});
      smallest = std::min(smallest, bound.hi);
    }
    std::vector<PolytopeKernel> narrowed;
    for (const Candidate& c : candidates) {
      if (c.lowest > smallest) continue;
      kept.push_back(items_[c.item]);
      narrowed.push_back(placed_[c.item].kernel->narrow(turned.moved(-kept.back().position)));
    }
    // Above the floor nothing grows, far below everything does by `closure`: then nobody asks the floor.
    const bool asks = crack_floor_ && !kept.empty() && growth.lo < growth.hi;
    return std::make_shared<PlacedBlocks>(root_, asks ? crack_floor_->narrow(box) : nullptr, growth.lo, std::move(kept),
                                          std::move(narrowed));
  }

  void labels(const Points& points, std::span<Label> labels) const noexcept override { root_->labels(points, labels); }

 private:
  [[nodiscard]] Interval growth_bound(const Box& box) const noexcept {
    if (!crack_floor_) return {growth_, growth_};
    const Interval floor = crack_floor_->bound(box);
    const ReplicationOptions& o = root_->options_;
    return {std::clamp(-o.closure_slope * floor.hi, 0.0, o.closure), std::clamp(-o.closure_slope * floor.lo, 0.0, o.closure)};
  }

  /// Outside its support a block's value is at least the cap.
  [[nodiscard]] bool reaches(const Item& item, const Box& tile_box) const noexcept {
    return root_->shapes_[item.block].support.moved(item.position).overlaps(tile_box);
  }

  [[nodiscard]] Interval bound_of(std::size_t k, const TurnedBox& turned, const Interval& growth) const noexcept {
    const Interval b = placed_[k].kernel->bound(turned.moved(-items_[k].position));
    const double swelling = root_->options_.swelling;
    return {b.lo - swelling - growth.hi, b.hi - swelling - growth.lo};
  }

  void chunk(const Points& points, std::span<const double> floors, std::span<double> values,
             std::span<Vec3> gradients) const noexcept {
    const ReplicationOptions& o = root_->options_;
    const std::size_t n = points.size();
    const bool wants_gradients = !gradients.empty();
    std::array<double, kChunk> x, y, z, growth, before;
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
    if (wants_gradients) std::ranges::copy(values, before.begin());
    between_union(placed_, {{x.data(), n}, {y.data(), n}, {z.data(), n}}, std::span(growth).first(n), floors, values,
                  gradients);
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      if (values[i] == before[i]) continue;
      gradients[i] = root_->rock_.world_from_tile * gradients[i];
      if (crack_floor_) gradients[i] -= growth_gradients[i];
    }
  }

  std::shared_ptr<const Replication> root_;
  FieldPtr crack_floor_;
  double growth_;
  std::vector<Item> items_;
  std::vector<PolytopeKernel> narrowed_;  ///< One an item, or none: the root's.
  std::vector<PlacedKernel> placed_;
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
  arrangement_ = Arrangement(rock_.tile, reach, to_tile(options_.domain));
  place_blocks(*terrain, reach, task);
  if (options_.crack_floor) lipschitz_ += options_.closure_slope * options_.crack_floor->lipschitz();
  // Asked no more; what they refer to may end.
  options_.criterion = nullptr;
  options_.weight = nullptr;
  options_.slope = nullptr;
  options_.visible = nullptr;
  options_.body = nullptr;
}

std::vector<Block> Replication::make_shapes(double reach, const std::vector<char>& used) {
  std::vector<Block> blocks;
  std::vector<double> volumes;
  const auto whole_volume = [](const Block* part) {
    double volume = 0.0;
    for (const Block* p = part - part->part; p < part - part->part + part->parts; ++p) volume += p->volume;
    return volume;
  };
  for (const Block& block : rock_.tile.blocks)
    if (block.part == 0) volumes.push_back(whole_volume(&block));
  std::ranges::sort(volumes);
  lists_.resize(used.size());
  for (std::size_t l = 0; l < used.size(); ++l) {
    List& list = lists_[l];
    list.first = static_cast<std::uint32_t>(shapes_.size());
    if (!used[l]) continue;
    std::vector<Block> listed = arrangement_.blocks(rock_.tile, l);
    for (const Block& block : listed) {
      PolytopeKernel kernel(block.planes, block.rounding, rock_.warp, block.centre);
      lipschitz_ = std::max(lipschitz_, kernel.lipschitz());
      // The centre's smallest plane distance, not the reported ball: the proof of support_box needs exactly that.
      double inner = std::numeric_limits<double>::infinity();
      for (const Plane& plane : block.planes) inner = std::min(inner, -plane.offset);
      const auto larger = volumes.end() - std::ranges::upper_bound(volumes, whole_volume(&block));
      shapes_.push_back({.kernel = std::move(kernel),
                         .centre = block.home,
                         .support = support_box(block.bounds, std::max(inner, 1e-3), reach),
                         .world = rotated(rock_.world_from_tile, block.bounds),
                         .inradius = block.inradius,
                         .size_rank = static_cast<double>(larger) / static_cast<double>(volumes.size())});
      supports_in_tile_.push_back(shapes_.back().support.moved(block.home));
      list.support = hull(list.support, supports_in_tile_.back());
      const Vec3 size = block.bounds.size();
      half_block_ += block.bounds.half_diagonal();
      // A block is 1-Lipschitz before its warp, which only adds: no value lies deeper than half of its smallest extent.
      deepest_ = std::max(deepest_, 0.5 * std::min({size.x, size.y, size.z}));
    }
    std::ranges::move(listed, std::back_inserter(blocks));
    list.count = static_cast<std::uint32_t>(shapes_.size()) - list.first;
  }
  half_block_ /= static_cast<double>(std::max<std::size_t>(shapes_.size(), 1));
  deepest_ += options_.swelling + options_.closure;
  return blocks;
}

Box Replication::to_tile(const Box& world) const noexcept {
  return rotated(tile_from_world_, world.moved(-rock_.origin)).grown(1e-9);
}

TurnedBox Replication::turned(const Box& world) const noexcept {
  const Vec3 half = 0.5 * world.size() + kFloatSlack;
  return {to_tile(world.centre()),
          {tile_from_world_[0] * half.x, tile_from_world_[1] * half.y, tile_from_world_[2] * half.z}};
}

void Replication::place_blocks(const Field& terrain, double reach, const Task& task) {
  struct Numbered {
    std::size_t index;
    Arrangement::Copy copy;
  };
  std::vector<Numbered> copies;
  std::vector<char> used(arrangement_.list_count(), 0);
  arrangement_.visit(to_tile(options_.domain), [&](std::size_t index, const Arrangement::Copy& copy) {
    copies.push_back({index, copy});
    used[copy.list] = 1;
    return true;
  });
  const std::vector<Block> blocks = make_shapes(reach, used);
  task.begin("placing blocks", copies.size());
  const auto masks = parallel_map(
      copies.size(),
      [&](std::size_t i) {
        task.advance();
        const Arrangement::Copy& copy = copies[i].copy;
        const List& list = lists_[copy.list];
        if (list.count == 0) return std::vector<std::uint64_t>{};
        const Box box =
            rotated(rock_.world_from_tile, list.support.moved(copy.origin)).moved(rock_.origin).grown(kFloatSlack);
        if (!box.overlaps(options_.domain) || (options_.visible && !options_.visible(box))) return std::vector<std::uint64_t>{};
        return present_blocks(copy, terrain, blocks);
      },
      task);
  presence_of_.assign(arrangement_.size(), 0);
  for (std::size_t i = 0; i < copies.size(); ++i) {
    std::size_t count = 0;
    for (const std::uint64_t word : masks[i]) count += static_cast<std::size_t>(std::popcount(word));
    if (count == 0) continue;
    presence_of_[copies[i].index] = static_cast<std::uint32_t>(presence_.size());
    presence_.insert(presence_.end(), masks[i].begin(), masks[i].end());
    block_count_ += count;
  }
}

std::vector<std::uint64_t> Replication::present_blocks(const Arrangement::Copy& copy, const Field& terrain,
                                                       const std::vector<Block>& blocks) const {
  const List& list = lists_[copy.list];
  std::vector<std::uint64_t> mask((list.count + 63) / 64, 0);
  std::vector<double> x, y, z, values;
  std::vector<Vec3> gradients;
  std::vector<Label> labels;
  std::vector<Anchor> anchors;
  for (std::size_t i = 0; i < list.count; ++i) {
    const Shape& shape = shapes_[list.first + i];
    const Block& block = blocks[list.first + i];
    if (shape.inradius < options_.min_inradius) continue;
    const Vec3 world_centre = rock_.origin + rock_.world_from_tile * (copy.origin + shape.centre);
    const Box world = shape.world.moved(world_centre);
    if (!world.overlaps(options_.domain) || (options_.visible && !options_.visible(world))) continue;
    Reach reach = reach_into_body(block, world_centre);
    if (reach == Reach::None) continue;
    // What is not convex is there as a whole: of all its parts' anchors those in the body count.
    if (block.parts > 1 && options_.body) reach = Reach::Part;
    if (options_.criterion || options_.weight) {
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
      std::span<const Anchor> counting = anchors;
      if (reach == Reach::Part) {
        options_.body->values(points, values, {});
        std::size_t inside = 0;
        for (std::size_t k = 0; k < n; ++k)
          if (values[k] < 0.0) std::swap(anchors[inside++], anchors[k]);
        if (inside > 0) counting = counting.first(inside);
      }
      if (options_.criterion && !present(options_.criterion, counting)) continue;
      if (options_.weight) {
        const double weight = mean_weight(options_.weight, counting);
        if (weight < 1.0 && weight <= drop_threshold(copy.id, i - block.part, shape.size_rank)) continue;
      }
    }
    mask[i / 64] |= 1ull << (i % 64);
  }
  return mask;
}

Replication::Reach Replication::reach_into_body(const Block& block, const Vec3& world_centre) const {
  if (!options_.body) return Reach::Whole;
  const Field& body = *options_.body;
  const Box bounds = block.bounds;
  const double around = body.lipschitz() * glm::length(glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi)));
  const double middle = body.value(world_centre);
  if (middle >= around) return Reach::None;
  if (middle <= -around) return Reach::Whole;
  // Along the block's edges, in steps that its body's Lipschitz constant allows: a bed may pass between the corners. A
  // splinter that the resolution cannot show is left out.
  const BlockMesh& hull = block.hull;
  double deepest = middle, shallowest = middle;
  for (const auto& triangle : hull.triangles)
    for (int corner = 0; corner < 3; ++corner) {
      if (triangle[corner] > triangle[(corner + 1) % 3]) continue;  // Each edge once, in one of its two triangles.
      const Vec3 from = world_centre + rock_.world_from_tile * hull.vertices[triangle[corner]];
      const Vec3 along =
          rock_.world_from_tile * (hull.vertices[triangle[(corner + 1) % 3]] - hull.vertices[triangle[corner]]);
      const double step = 1.0 / (body.lipschitz() * std::max(glm::length(along), 1e-9));
      for (double t = 0.0; t < 1.0 + kEdgeStep;) {
        const double value = body.value(from + std::min(t, 1.0) * along);
        deepest = std::min(deepest, value);
        shallowest = std::max(shallowest, value);
        t += std::max(std::abs(value) * step, kEdgeStep);
      }
    }
  return deepest > -kSplinter * options_.min_inradius ? Reach::None : shallowest <= 0.0 ? Reach::Whole : Reach::Part;
}

double Replication::drop_threshold(const IVec3& copy, std::size_t block, double size_rank) const {
  // Copies are fewer than 2²¹ along each axis.
  std::uint64_t index = 0;
  for (int axis = 0; axis < 3; ++axis) index = (index << 21) | (static_cast<std::uint64_t>(copy[axis]) & 0x1FFFFF);
  Rng rng(options_.seed ^ (static_cast<std::uint64_t>(block) * 0x9E3779B97F4A7C15ull), "presence", index);
  return outcrop::drop_threshold(size_rank, rng.uniform());
}

bool Replication::block_present(const IVec3& copy, std::size_t block) const noexcept {
  const std::size_t index = arrangement_.index(copy);
  const std::uint64_t* const present = index < arrangement_.size() ? presence(index) : nullptr;
  return present && ((present[block / 64] >> (block % 64)) & 1) != 0;
}

std::size_t Replication::tile_bytes() const noexcept {
  std::size_t bytes = lists_.size() * sizeof(List);
  for (const Shape& shape : shapes_)
    bytes += sizeof(Shape) + sizeof(Box) + shape.kernel.plane_count() * 4 * sizeof(float);
  return bytes;
}

template <class Visit>
void Replication::visit_blocks(const Box& tile_box, Visit&& visit) const {
  arrangement_.visit(tile_box, [&](std::size_t index, const Arrangement::Copy& copy) {
    const std::uint64_t* const present = presence(index);
    if (!present) return true;
    const List& list = lists_[copy.list];
    const Box local = tile_box.moved(-copy.origin).grown(kFloatSlack);
    if (!list.support.overlaps(local)) return true;
    for (std::uint32_t w = 0; w < (list.count + 63) / 64; ++w)
      for (std::uint64_t bits = present[w]; bits != 0; bits &= bits - 1) {
        const std::uint32_t shape = list.first + 64 * w + static_cast<std::uint32_t>(std::countr_zero(bits));
        if (supports_in_tile_[shape].overlaps(local) && !visit(shape, copy.origin + shapes_[shape].centre)) return false;
      }
    return true;
  });
}

void Replication::values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  for (std::size_t i = 0; i < points.size(); ++i) {
    double best = options_.cap;
    Vec3 best_gradient(0.0);
    bool has_growth = false;
    double growth = options_.swelling;
    Vec3 growth_gradient(0.0);
    const Vec3 p = to_tile(points[i]);
    visit_blocks({p, p}, [&](std::uint32_t block, const Vec3& position) {
      const Shape& shape = shapes_[block];
      const Vec3 local = p - position;
      if (!shape.support.contains(local)) return true;
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
      if (value >= best) return true;
      best = value;
      best_gradient = rock_.world_from_tile * Vec3(g) - growth_gradient;
      return true;
    });
    values[i] = best;
    if (!gradients.empty()) gradients[i] = best_gradient;
  }
}

double Replication::lipschitz() const noexcept { return lipschitz_; }

Modulus Replication::modulus() const noexcept {
  const double growth = options_.crack_floor ? options_.closure_slope * options_.crack_floor->lipschitz() : 0.0;
  return {1.0 + growth, rock_.warp.active() ? rock_.warp.amplitude : 0.0};
}

std::shared_ptr<const PlacedBlocks> Replication::blocks_in(const Box& box, std::size_t most) const {
  std::vector<PlacedBlocks::Item> items;
  visit_blocks(to_tile(box), [&](std::uint32_t block, const Vec3& position) {
    items.push_back({block, position});
    return items.size() <= most;
  });
  if (items.size() > most) return nullptr;
  return std::make_shared<PlacedBlocks>(std::static_pointer_cast<const Replication>(shared_from_this()),
                                        options_.crack_floor, 0.0, std::move(items), std::vector<PolytopeKernel>{});
}

Interval Replication::bound(const Box& box) const noexcept {
  if (!large(box)) return blocks_in(box, std::numeric_limits<std::size_t>::max())->bound(box);
  Interval result{options_.cap, options_.cap};
  visit_blocks(to_tile(box), [&](std::uint32_t, const Vec3&) {
    result.lo = -deepest_;
    return false;
  });
  return result;
}

FieldPtr Replication::narrow(const Box& box) const {
  const std::shared_ptr<const PlacedBlocks> blocks = blocks_in(box, kWorthAList);
  if (!blocks) return shared_from_this();
  return large(box) ? blocks : blocks->narrow(box);
}

void Replication::labels(const Points&, std::span<Label> labels) const noexcept {
  std::ranges::fill(labels, rock_.label);
}

}  // namespace outcrop

#include "outcrop/tiles/arrangement.h"

#include "outcrop/core/error.h"
#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

constexpr double kFarthest = 1 << 20;    // Slabs, rods and copies from the origin.
constexpr double kLeastInner = 1e-3;     // Metres from a block's centre to its nearest plane.
constexpr double kSlack = 1e-4;          // Metres: rounding.
constexpr double kOffPlace = 0.08;       // Of the distance between walls. More would show in the angles between joints.
constexpr int kSizes = 3;                // Between two walls: both may be off towards each other, or away.
constexpr double kMostStretch = 1.0 + 2.0 * kOffPlace;
constexpr double kLeastStretch = 0.5;    // Of any length, where walls meet at 35°.
constexpr int kTurns = 3;
constexpr double kTurnDeg[kTurns] = {-8.0, 2.0, 6.0};  // None is 0: no rod runs along a wall that is parallel to the lattice.

// A number of its own for every pair.
std::uint64_t pair_index(int a, int b) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
}

double stretch_of(int size) { return 1.0 + 2.0 * kOffPlace * (size - 1); }

Interval scaled(const Interval& interval, double by) { return {by * interval.lo, by * interval.hi}; }

void require_near(const Interval& numbers) {
  require(std::max(std::abs(numbers.lo), std::abs(numbers.hi)) < kFarthest, "domain", "at most 2^20 tiles from the origin",
          numbers.hi);
}

Vec3 turned(const Vec3& v, const Vec3& about, double angle) {
  return std::cos(angle) * v + std::sin(angle) * glm::cross(about, v) + (1.0 - std::cos(angle)) * glm::dot(about, v) * about;
}

}  // namespace

Arrangement::Arrangement(const Tile& tile, double reach, const Box& domain)
    : layout_(tile.layout), variants_(1 + tile.others.size()) {
  const bool turns = layout_.slides && layout_.layers.size() > 1;
  for (std::size_t l = 0; l < layout_.layers.size(); ++l)
    for (int t = 0; t < (turns ? kTurns : 1); ++t) add_frame(tile, l, turns ? radians(kTurnDeg[t]) : 0.0, reach);
  for (const Frame& frame : frames_) overhang_ = hull(overhang_, scaled(frame.reaches[0], kMostStretch));
  const Interval up = along(domain, layout_.normal);
  const double floor = layout_.layers[0].floor;
  const Interval slabs{std::floor((up.lo - overhang_.hi - floor) / layout_.pitch - kOffPlace),
                       std::floor((up.hi - overhang_.lo - floor) / layout_.pitch + kOffPlace)};
  require_near(slabs);
  for (int slab = static_cast<int>(slabs.lo); slab <= static_cast<int>(slabs.hi); ++slab) add_slab(slab, domain);
}

void Arrangement::add_frame(const Tile& tile, std::size_t l, double turn, double reach) {
  const TileLayout::Layer& layer = layout_.layers[l];
  Frame frame;
  frame.normals = {layout_.normal, turned(layer.side_normal, layout_.normal, turn),
                   turned(layer.end_normal, layout_.normal, turn)};
  frame.offsets = {layer.floor, layer.side_offset, layer.end_offset};
  frame.axis = turned(layer.axis, layout_.normal, turn);
  frame.across = glm::cross(layout_.normal, frame.axis);
  frame.rod_step = layer.side_pitch / glm::dot(frame.normals[1], frame.across);
  frame.copy_step = layer.period * glm::dot(frame.normals[2], frame.axis);
  const Vec3 volume = glm::cross(frame.normals[0], frame.normals[1]);
  const double det = glm::dot(volume, frame.normals[2]);
  frame.edges = {glm::cross(frame.normals[1], frame.normals[2]) / det, glm::cross(frame.normals[2], frame.normals[0]) / det,
                 volume / det};
  const Vec3 base[3] = {layout_.normal, layer.side_normal, layer.end_normal};
  for (std::size_t v = 0; v < variants_; ++v)
    for (const Block& block : v == 0 ? tile.blocks : tile.others[v - 1]) {
      if (static_cast<std::size_t>(block.layer) != l) continue;
      // Every plane has offset d ≤ −r, so that n · x + d ≤ t gives n · x ≤ −d (1 + t / r): the polytope, scaled.
      double inner = 1e300;
      for (const Plane& plane : block.planes) inner = std::min(inner, -plane.offset);
      const double scale = 1.0 + reach / std::max(kLeastStretch * inner, kLeastInner);
      for (const Vec3& vertex : block.hull.vertices)
        for (int i = 0; i < 3; ++i)
          frame.reaches[static_cast<std::size_t>(i)].include(glm::dot(base[i], block.home + scale * vertex) - frame.offsets[i]);
    }
  for (Interval& interval : frame.reaches) {
    if (interval.empty()) interval = {0.0, 0.0};  // a layer without blocks
    interval = {interval.lo - kSlack, interval.hi + kSlack};
  }
  frames_.push_back(frame);
}

void Arrangement::add_slab(int slab, const Box& domain) {
  const std::size_t count = layout_.layers.size();
  const std::size_t turns = frames_.size() / count;
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i;
  if (layout_.slides) {
    Rng rng(layout_.seed, "layer order", pair_index(slab, 0));
    for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[rng.below(i)]);
  }
  const int size = size_of("slab walls", 0, slab);
  double height = layout_.layers[0].floor + wall("slab walls", 0, slab) * layout_.pitch;
  for (std::size_t i = 0; i < count; ++i) {
    const TileLayout::Layer& layer = layout_.layers[order[i]];
    PlacedLayer placed{.layer = order[i], .id = slab * static_cast<int>(count) + static_cast<int>(i), .floor = height,
                       .size = size, .first = size_};
    const std::uint64_t number = pair_index(placed.id, 0);
    placed.frame = order[i] * turns + (turns > 1 ? Rng(layout_.seed, "layer turn", number).below(turns) : 0);
    const Frame& frame = frames_[placed.frame];
    const Interval up = scaled(frame.reaches[0], stretch_of(size));
    placed.reach = {height + up.lo, height + up.hi};
    height += stretch_of(size) * layer.thickness;
    const double slide = layout_.slides ? frame.rod_step * Rng(layout_.seed, "layer slide", number).uniform() : 0.0;
    const Vec3 moved = (placed.floor - layer.floor) * layout_.normal + slide * frame.across;
    const double start = glm::dot(frame.normals[1], moved) + frame.offsets[1];
    const Interval aside = scaled(frame.reaches[1], layout_.slides ? kMostStretch : 1.0);
    const double off = layout_.slides ? kOffPlace * layer.side_pitch : 0.0;
    placed.rod_reach = {start + aside.lo - off, start + aside.hi + off};
    const Interval wanted = along(domain, frame.normals[1]);
    const Interval rods{std::ceil((wanted.lo - placed.rod_reach.hi) / layer.side_pitch),
                        std::floor((wanted.hi - placed.rod_reach.lo) / layer.side_pitch)};
    require_near(rods);
    placed.first_rod = static_cast<int>(rods.lo);
    for (int r = placed.first_rod; r <= static_cast<int>(rods.hi); ++r) {
      // Turned layers have rods of one thickness: a list has one of the two.
      const std::uint64_t in = static_cast<std::uint64_t>(placed.id);
      const double at = turns > 1 ? r : wall("rod walls", in, r);
      Rod rod{.size = turns > 1 ? 1 : size_of("rod walls", in, r)};
      const double along_axis =
          layout_.slides && !layout_.level ? layer.period * Rng(layout_.seed, "rod slide", pair_index(placed.id, r)).uniform() : 0.0;
      rod.origin = moved + at * frame.rod_step * frame.across + along_axis * frame.axis;
      const Interval rod_aside = scaled(frame.reaches[1], stretch_of(rod.size));
      rod.reach = {start + at * layer.side_pitch + rod_aside.lo, start + at * layer.side_pitch + rod_aside.hi};
      placed.rods.push_back(rod);
    }
    const Interval axial = along(domain, frame.normals[2]);
    Interval copies{0.0, -1.0};
    for (const Rod& rod : placed.rods) {
      const Interval reach = copy_reach(frame, rod);
      const Interval reaching{std::ceil((axial.lo - reach.hi) / frame.copy_step),
                              std::floor((axial.hi - reach.lo) / frame.copy_step)};
      copies = copies.empty() ? reaching : hull(copies, reaching);
    }
    require_near(copies);
    placed.first_copy = static_cast<int>(copies.lo);
    placed.copies = std::max(0, static_cast<int>(copies.hi) - placed.first_copy + 1);
    size_ += placed.rods.size() * static_cast<std::size_t>(placed.copies);
    layers_.push_back(std::move(placed));
  }
}

Interval Arrangement::copy_reach(const Frame& frame, const Rod& rod) const noexcept {
  const double start = glm::dot(frame.normals[2], rod.origin) + frame.offsets[2];
  const bool fixed = !layout_.slides || layout_.whole_rods;
  const Interval reach = scaled(frame.reaches[2], fixed ? 1.0 : kMostStretch);
  const double off = fixed ? 0.0 : kOffPlace * frame.copy_step;
  return {start + reach.lo - off, start + reach.hi + off};
}

Arrangement::Copy Arrangement::copy_of(const PlacedLayer& placed, std::size_t row, int number) const noexcept {
  const Rod& rod = placed.rods[row];
  const Frame& frame = frames_[placed.frame];
  const TileLayout::Layer& layer = layout_.layers[placed.layer];
  Copy copy{.id = {number, placed.first_rod + static_cast<int>(row), placed.id}, .list = placed.layer, .origin = rod.origin};
  const std::uint64_t in = Rng(layout_.seed, "rod", pair_index(copy.id.z, copy.id.y)).next();
  if (variants_ > 1)
    copy.list += layout_.layers.size() * Rng(in, "variant", layout_.whole_rods ? 0 : pair_index(number, 0)).below(variants_);
  if (!layout_.slides) {
    copy.origin += number * layer.period * frame.axis;
    return copy;
  }
  const std::size_t turns = frames_.size() / layout_.layers.size();
  const std::size_t second = turns > 1 ? placed.frame % turns : static_cast<std::size_t>(rod.size);
  const int length = layout_.whole_rods ? 1 : size_of("ends", in, number);
  copy.origin += (layout_.whole_rods ? number : wall("ends", in, number)) * layer.period * frame.axis;
  copy.list = ((copy.list * kSizes + static_cast<std::size_t>(placed.size)) * kSizes + second) * kSizes +
              static_cast<std::size_t>(length);
  return copy;
}

std::size_t Arrangement::list_count() const noexcept {
  return variants_ * layout_.layers.size() * (layout_.slides ? kSizes * kSizes * kSizes : 1);
}

std::vector<Block> Arrangement::blocks(const Tile& tile, std::size_t list) const {
  Vec3 sizes(1.0);
  std::size_t turn = 0;
  const std::size_t turns = frames_.size() / layout_.layers.size();
  if (layout_.slides) {
    sizes.z = stretch_of(static_cast<int>(list % kSizes));
    const std::size_t second = list / kSizes % kSizes;
    if (turns > 1)
      turn = second;
    else
      sizes.y = stretch_of(static_cast<int>(second));
    sizes.x = stretch_of(static_cast<int>(list / (kSizes * kSizes) % kSizes));
    list /= kSizes * kSizes * kSizes;
  }
  const std::size_t variant = list / layout_.layers.size();
  const std::size_t l = list % layout_.layers.size();
  const TileLayout::Layer& layer = layout_.layers[l];
  const Frame& frame = frames_[l * turns + turn];
  // x ↦ Σ edge_i (offset_i + size_i (n_i · x − offset_i)) keeps the walls of each kind parallel to themselves, but for the
  // turn.
  const Vec3 base[3] = {layout_.normal, layer.side_normal, layer.end_normal};
  Mat3 stretch(0.0);
  Vec3 shift(0.0);
  for (int i = 0; i < 3; ++i) {
    const Vec3& edge = frame.edges[static_cast<std::size_t>(i)];
    stretch += sizes[i] * glm::outerProduct(edge, base[i]);
    shift += (1.0 - sizes[i]) * frame.offsets[i] * edge;
  }
  const Mat3 of_normals = glm::transpose(glm::inverse(stretch));
  const bool plain = sizes == Vec3(1.0) && turns == 1;
  std::vector<Block> blocks;
  for (const Block& block : variant == 0 ? tile.blocks : tile.others[variant - 1]) {
    if (static_cast<std::size_t>(block.layer) != l) continue;
    blocks.push_back(block);
    if (plain) continue;
    Block& b = blocks.back();
    b.home = stretch * block.home + shift;
    b.inradius = 1e300;
    for (Plane& plane : b.planes) {
      const Vec3 normal = of_normals * plane.normal;
      const double length = glm::length(normal);
      plane = {normal / length, plane.offset / length};
      b.inradius = std::min(b.inradius, -plane.offset);
    }
    b.rounding = std::min(block.rounding, 0.5 * b.inradius);
    b.bounds = Box{};
    for (Vec3& vertex : b.hull.vertices) b.bounds.include(vertex = stretch * vertex);
    for (Vec3& anchor : b.anchors) anchor = stretch * anchor;
    b.volume *= sizes.x * sizes.y * sizes.z;
  }
  return blocks;
}

Interval Arrangement::along(const Box& box, const Vec3& direction) noexcept {
  const double middle = glm::dot(direction, box.centre());
  const double half = 0.5 * glm::dot(glm::abs(direction), box.size());
  return {middle - half, middle + half};
}

bool Arrangement::moved_on(std::string_view of, std::uint64_t in, int number) const noexcept {
  return (Rng(layout_.seed ^ in, of, pair_index(number, 0)).next() & 1) != 0;
}

double Arrangement::wall(std::string_view of, std::uint64_t in, int number) const noexcept {
  if (!layout_.slides) return number;
  return number + (moved_on(of, in, number) ? kOffPlace : -kOffPlace);
}

int Arrangement::size_of(std::string_view of, std::uint64_t in, int number) const noexcept {
  if (!layout_.slides) return 1;
  return 1 + static_cast<int>(moved_on(of, in, number + 1)) - static_cast<int>(moved_on(of, in, number));
}

std::size_t Arrangement::index(const IVec3& id) const noexcept {
  if (layers_.empty()) return size_;
  const int layer = id.z - layers_.front().id;
  if (layer < 0 || layer >= static_cast<int>(layers_.size())) return size_;
  const PlacedLayer& placed = layers_[static_cast<std::size_t>(layer)];
  const int rod = id.y - placed.first_rod, copy = id.x - placed.first_copy;
  if (rod < 0 || rod >= static_cast<int>(placed.rods.size()) || copy < 0 || copy >= placed.copies) return size_;
  return placed.first + static_cast<std::size_t>(rod) * static_cast<std::size_t>(placed.copies) +
         static_cast<std::size_t>(copy);
}

}  // namespace outcrop

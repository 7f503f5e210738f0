#include "rock_zone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "outcrop/core/parallel.h"

namespace outcrop {
namespace {

constexpr std::size_t kChunk = 256;
constexpr double kRecessGrowth = 4.0;   // Metres of recess radius a metre from the rim: the base hides behind blocks at once.
constexpr double kLedge = 0.65;         // Block sizes; half the width of ledges that blocks may cover.
constexpr double kSpot = 0.3;           // Block sizes; half the width of steep spots that stay ground.
constexpr double kSteepestFoot = 4.0;   // Tangent of the slope by which the base goes on below the foot of a wall.
constexpr double kBareSlope = 0.15;     // Radians beyond the threshold at which ground without blocks is bare rock.
constexpr double kAdvanceGrowth = 0.75; // Of advance: blocks come out of the ground gradually.

/// A raster of nodes over a rectangle, rows from the south.
struct Raster {
  int width = 0, height = 0;
  Vec2 lo{0.0};
  double spacing = 1.0;

  [[nodiscard]] std::size_t index(int column, int row) const { return static_cast<std::size_t>(row) * width + column; }
  [[nodiscard]] Vec2 node(int column, int row) const { return lo + spacing * Vec2(column, row); }
  /// The index of a neighbour; beyond the border, of the nearest node.
  [[nodiscard]] std::size_t neighbour(int column, int row, int dx, int dy) const {
    return index(std::clamp(column + dx, 0, width - 1), std::clamp(row + dy, 0, height - 1));
  }

  [[nodiscard]] Heightfield layer(const std::vector<float>& nodes) const {
    ElevationGrid grid{.width = width, .height = height, .cell_x = spacing, .cell_y = spacing, .origin = lo};
    grid.elevations.resize(nodes.size());
    for (int row = 0; row < height; ++row)
      std::copy_n(nodes.begin() + static_cast<std::ptrdiff_t>(index(0, row)), width,
                  grid.elevations.begin() + static_cast<std::ptrdiff_t>(index(0, height - 1 - row)));
    return Heightfield(std::move(grid), Interpolation::Bilinear);
  }
};

struct Offset {
  int dx, dy;
  double distance;
};

/// Raster offsets within `radius`, nearest first.
std::vector<Offset> disc_offsets(double radius, double spacing) {
  const int reach = static_cast<int>(std::ceil(radius / spacing));
  std::vector<Offset> offsets;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const double distance = spacing * std::hypot(dx, dy);
      if (distance <= radius + spacing) offsets.push_back({dx, dy, distance});
    }
  std::ranges::stable_sort(offsets, {}, &Offset::distance);
  return offsets;
}

/// Erodes (keep = true) or dilates (keep = false) a mask of steep nodes by the offsets: a node becomes `keep`'s opposite when
/// any neighbour is. Beyond the raster its border goes on.
std::vector<char> shifted(const Raster& raster, const std::vector<char>& mask, const std::vector<Offset>& offsets, bool keep) {
  std::vector<char> result(mask.size());
  parallel_for(static_cast<std::size_t>(raster.height), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < raster.width; ++column)
      result[raster.index(column, row)] =
          keep == std::ranges::all_of(offsets, [&](const Offset& o) {
            return (mask[raster.neighbour(column, row, o.dx, o.dy)] != 0) == keep;
          });
  });
  return result;
}

/// The mask at the scale of blocks: ledges narrower than twice `ledge` count as wall, steep spots narrower than twice `spot`
/// as ground. (Morphological closing, then opening.) Wide flats keep every node.
std::vector<char> at_block_scale(const Raster& raster, std::vector<char> mask, double ledge, double spot) {
  const std::vector<Offset> closing = disc_offsets(ledge - raster.spacing, raster.spacing);
  const std::vector<Offset> opening = disc_offsets(spot - raster.spacing, raster.spacing);
  mask = shifted(raster, shifted(raster, mask, closing, false), closing, true);
  return shifted(raster, shifted(raster, mask, opening, true), opening, false);
}

Box flat_box(const Vec2& lo, const Vec2& hi) { return {Vec3(lo, 0.0), Vec3(hi, 0.0)}; }

class DisplacedTerrain final : public Field {
 public:
  DisplacedTerrain(FieldPtr terrain, Heightfield layer, double factor, const Box& rectangle)
      : terrain_(std::move(terrain)), layer_(std::move(layer)), factor_(factor) {
    lipschitz_ = terrain_->lipschitz() + std::abs(factor_) * layer_.slope_bound(Vec2(rectangle.lo), Vec2(rectangle.hi));
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    terrain_->values(points, values, gradients);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Heightfield::Sample s = layer_.at(points.x[i], points.y[i]);
      values[i] += factor_ * s.h;
      if (!gradients.empty()) gradients[i] += factor_ * Vec3(s.hx, s.hy, 0.0);
    }
  }
  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval f = terrain_->bound(box);
    const Interval e = layer_.height_bound(Vec2(box.lo), Vec2(box.hi));
    return {f.lo + std::min(factor_ * e.lo, factor_ * e.hi), f.hi + std::max(factor_ * e.lo, factor_ * e.hi)};
  }
  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    return std::make_shared<DisplacedTerrain>(terrain_->narrow(box), layer_, factor_, box);
  }

 private:
  FieldPtr terrain_;
  Heightfield layer_;
  double factor_;
  double lipschitz_ = 1.0;
};

/// Which of the three surfaces can be the field's somewhere in a box.
struct Contenders {
  bool clip = true, base = true, rock = true;
};

/// See rock_on_terrain. What is no contender is neither evaluated nor counted in the Lipschitz constant.
class RockOnTerrain final : public Field {
 public:
  RockOnTerrain(FieldPtr terrain, RockZone zone, FieldPtr rock, FieldPtr strata, Label ground, Contenders contenders,
                const Box& rectangle)
      : terrain_(std::move(terrain)),
        zone_(std::move(zone)),
        rock_(std::move(rock)),
        strata_(std::move(strata)),
        ground_(ground),
        cos_slope_(std::cos(std::min(zone_.slope + kBareSlope, 0.5 * kPi))),
        can_(contenders) {
    const Vec2 lo(rectangle.lo), hi(rectangle.hi);
    if (can_.base) lipschitz_ = terrain_->lipschitz() + zone_.recess.slope_bound(lo, hi);
    if (can_.clip) lipschitz_ = std::max(lipschitz_, terrain_->lipschitz() + zone_.advance.slope_bound(lo, hi));
    if (can_.rock) lipschitz_ = std::max(lipschitz_, rock_->lipschitz());
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t count = std::min(kChunk, points.size() - first);
      chunk(points.subspan(first, count), values.subspan(first, count),
            gradients.empty() ? gradients : gradients.subspan(first, count));
    }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override { return parts(box).whole; }

  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    const Parts p = parts(box);
    if (p.outside) return terrain_->narrow(box);
    // min and max return one of their arguments: a contender that loses everywhere in the box is dropped to the bit.
    Contenders can = can_;
    can.rock = can_.rock && !(can_.base && p.rock.lo > p.base.hi);
    can.base = can_.base && !(can.rock && p.base.lo > p.rock.hi);
    can.clip = can_.clip && !(p.clip.hi < p.inner.lo);
    if (!can.base && !can.clip) return rock_->narrow(box);
    return std::make_shared<RockOnTerrain>(terrain_->narrow(box), zone_, can.rock ? rock_->narrow(box) : nullptr, strata_,
                                           ground_, can, box);
  }

  void labels(const Points& points, std::span<Label> labels) const noexcept override {
    strata_->labels(points, labels);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points[i];
      const double recess = zone_.recess.at(p.x, p.y).h;
      const bool outside = recess <= 0.0 && zone_.advance.at(p.x, p.y).h <= 0.0;
      if (!outside && can_.rock && (!can_.base || rock_->value(p) < terrain_->value(p) + recess)) {
        rock_->labels(points.subspan(i, 1), labels.subspan(i, 1));
      } else {
        const Vec3 up = terrain_->gradient(p);
        if (up.z > cos_slope_ * glm::length(up)) labels[i] = ground_;
      }
    }
  }

 private:
  struct Parts {
    bool outside;  ///< Both envelopes are 0 in the box.
    Interval clip, base, rock, inner, whole;
  };

  [[nodiscard]] Parts parts(const Box& box) const noexcept {
    const Vec2 lo(box.lo), hi(box.hi);
    const Interval recess = zone_.recess.height_bound(lo, hi);
    const Interval advance = zone_.advance.height_bound(lo, hi);
    const Interval f = terrain_->bound(box);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Parts p{.outside = recess.hi <= 0.0 && advance.hi <= 0.0,
            .clip = {f.lo - advance.hi, f.hi - std::max(advance.lo, 0.0)},
            .base = {f.lo + std::max(recess.lo, 0.0), f.hi + recess.hi},
            .rock = {-kInfinity, kInfinity},
            .inner = {-kInfinity, kInfinity},
            .whole = f};
    if (p.outside) return p;
    // Where all of the box is air above the clip or rock below the base, the blocks need not be asked.
    if (can_.rock && can_.base && (p.clip.lo > 0.0 || p.base.hi < 0.0)) {
      p.whole = {can_.clip ? p.clip.lo : -kInfinity, std::max(p.clip.hi, p.base.hi)};
      if (std::isfinite(p.whole.lo)) return p;
    }
    if (can_.rock) p.rock = rock_->bound(box);
    p.inner = !can_.rock ? p.base : !can_.base ? p.rock : outcrop::min(p.base, p.rock);
    p.whole = can_.clip ? outcrop::max(p.clip, p.inner) : p.inner;
    return p;
  }

  void chunk(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
    const std::size_t n = points.size();
    const bool wants_gradients = !gradients.empty();
    terrain_->values(points, values, gradients);
    std::array<Heightfield::Sample, kChunk> recess, advance;
    bool any = false;
    for (std::size_t i = 0; i < n; ++i) {
      recess[i] = zone_.recess.at(points.x[i], points.y[i]);
      advance[i] = zone_.advance.at(points.x[i], points.y[i]);
      any = any || recess[i].h > 0.0 || advance[i].h > 0.0;
    }
    if (!any) return;
    std::array<double, kChunk> rock;
    std::array<Vec3, kChunk> rock_gradients;
    if (can_.rock)
      rock_->values(points, {rock.data(), n}, wants_gradients ? std::span(rock_gradients).first(n) : std::span<Vec3>{});
    for (std::size_t i = 0; i < n; ++i) {
      const double f = values[i];
      const bool rock_wins = can_.rock && (!can_.base || rock[i] < f + recess[i].h);
      const double inner = rock_wins ? rock[i] : f + recess[i].h;
      const double clip = f - advance[i].h;
      const bool clip_wins = can_.clip && clip > inner;
      values[i] = clip_wins ? clip : inner;
      if (!wants_gradients) continue;
      if (clip_wins)
        gradients[i] -= Vec3(advance[i].hx, advance[i].hy, 0.0);
      else if (rock_wins)
        gradients[i] = rock_gradients[i];
      else
        gradients[i] += Vec3(recess[i].hx, recess[i].hy, 0.0);
    }
  }

  FieldPtr terrain_;
  RockZone zone_;
  FieldPtr rock_, strata_;
  Label ground_;
  double cos_slope_;
  Contenders can_;
  double lipschitz_ = 1.0;
};

}  // namespace

RockZone make_rock_zone(const Heightfield& heightfield, const RockZoneOptions& options, const Task& task) {
  const Vec2 extent = options.hi - options.lo;
  const Raster raster{.width = static_cast<int>(std::ceil(extent.x / options.spacing)) + 1,
                      .height = static_cast<int>(std::ceil(extent.y / options.spacing)) + 1,
                      .lo = options.lo,
                      .spacing = options.spacing};
  const std::size_t count = static_cast<std::size_t>(raster.width) * raster.height;
  const double steep_tangent = std::tan(options.slope);
  std::vector<float> ground(count), reach(count, static_cast<float>(options.reach));
  std::vector<char> steep(count);
  const auto rows = static_cast<std::size_t>(raster.height);
  task.begin("finding steep ground", 2 * rows);
  parallel_for(rows, [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < raster.width; ++column) {
      const Vec2 p = raster.node(column, row);
      ground[raster.index(column, row)] = static_cast<float>(heightfield.at(p.x, p.y).h);
      // A node is steep when the ground about it is, so that no flat point lies in a raster cell with a steep node.
      bool is_steep = true;
      constexpr int kProbes = 2;
      for (int dy = -kProbes; dy <= kProbes && is_steep; ++dy)
        for (int dx = -kProbes; dx <= kProbes && is_steep; ++dx) {
          const Vec2 q = p + Vec2(dx, dy) * (1.05 * options.spacing / kProbes);
          const Heightfield::Sample s = heightfield.at(q.x, q.y);
          is_steep = s.hx * s.hx + s.hy * s.hy >= steep_tangent * steep_tangent;
          if (heightfield.has_holes()) is_steep = is_steep && heightfield.hole_distance(q.x, q.y) < 0.0;
        }
      const std::size_t here = raster.index(column, row);
      if (is_steep && options.reach_at) reach[here] = static_cast<float>(options.reach_at(Vec3(p, ground[here])));
      steep[here] = is_steep && reach[here] > 0.0f;
    }
    task.advance();
  }, task);

  if (options.block_size > 0.0)
    steep = at_block_scale(raster, std::move(steep), kLedge * options.block_size, kSpot * options.block_size);

  const double largest_radius = options.reach * std::max(1.0, options.recess);
  const std::vector<Offset> offsets = disc_offsets(largest_radius, options.spacing);
  std::vector<float> recess(count, 0.0f), advance(count, 0.0f), nearby(count, 0.0f);
  parallel_for(rows, [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < raster.width; ++column) {
      const auto neighbour = [&](const Offset& o) { return raster.neighbour(column, row, o.dx, o.dy); };
      const std::size_t here = raster.index(column, row);
      if (!steep[here]) {
        nearby[here] = std::ranges::any_of(offsets, [&](const Offset& o) { return steep[neighbour(o)]; }) ? 1.0f : 0.0f;
        continue;
      }
      nearby[here] = 1.0f;
      double rim = largest_radius + options.spacing;  // Distance to ground that is not steep.
      for (const Offset& o : offsets)
        if (!steep[neighbour(o)]) {
          rim = std::min(rim, o.distance);
          break;
        }
      // Both radii grow from 0 at the rim, so that the rim is no staircase of the raster.
      const double depth = rim - options.spacing;
      const double recess_radius = std::min<double>(kRecessGrowth * depth, options.recess * reach[here]);
      const double advance_radius = std::min<double>(kAdvanceGrowth * depth, reach[here]);
      float lowest = 0.0f, highest = 0.0f;
      for (const Offset& o : offsets) {
        const auto weight = [&](double radius) {
          return static_cast<float>(std::clamp(1.0 + (radius - o.distance) / options.spacing, 0.0, 1.0));
        };
        const float difference = ground[neighbour(o)] - ground[here];
        lowest = std::min(lowest, weight(recess_radius) * difference);
        highest = std::max(highest, weight(advance_radius) * difference);
      }
      // At the foot of a wall the lowest ground near by is the floor itself; blocks stand below it all the same.
      const Vec2 p = raster.node(column, row);
      const Heightfield::Sample s = heightfield.at(p.x, p.y);
      const double slope = std::min(std::hypot(s.hx, s.hy), kSteepestFoot);
      recess[here] = std::max(-lowest, static_cast<float>(slope * recess_radius));
      advance[here] = highest;
    }
    task.advance();
  }, task);
  const bool empty = std::ranges::none_of(steep, [](char s) { return s != 0; });
  return {raster.layer(recess), raster.layer(advance), raster.layer(nearby), options.slope, empty};
}

FieldPtr displaced_terrain(FieldPtr terrain, Heightfield layer, double factor) {
  const Box rectangle = flat_box(layer.lo(), layer.hi());
  return std::make_shared<DisplacedTerrain>(std::move(terrain), std::move(layer), factor, rectangle);
}

FieldPtr rock_on_terrain(FieldPtr terrain, RockZone zone, FieldPtr rock, FieldPtr strata, Label ground) {
  const Box rectangle = flat_box(zone.recess.lo(), zone.recess.hi());
  return std::make_shared<RockOnTerrain>(std::move(terrain), std::move(zone), std::move(rock), std::move(strata), ground,
                                         Contenders{.rock = rock != nullptr}, rectangle);
}

}  // namespace outcrop

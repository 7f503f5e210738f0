#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "rock_zone.h"

namespace outcrop {
namespace {

constexpr std::size_t kChunk = 768;  // Points at a time: a mesher's brick of 9³.
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBareSlope = 0.15;  // Radians beyond the threshold at which ground without blocks is bare rock.

Box flat_box(const Vec2& lo, const Vec2& hi) { return {Vec3(lo, 0.0), Vec3(hi, 0.0)}; }

class DisplacedTerrain final : public Field {
 public:
  DisplacedTerrain(FieldPtr terrain, RasterLayer layer, double factor, const Box& rectangle)
      : terrain_(std::move(terrain)), layer_(std::move(layer)), factor_(factor) {
    lipschitz_ = terrain_->lipschitz() + std::abs(factor_) * layer_.slope_bound(Vec2(rectangle.lo), Vec2(rectangle.hi));
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    terrain_->values(points, values, gradients);
    std::array<Heightfield::Sample, kChunk> layer;
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t n = std::min(kChunk, points.size() - first);
      layer_.at(points.x.subspan(first, n), points.y.subspan(first, n), std::span(layer).first(n));
      for (std::size_t i = 0; i < n; ++i) {
        values[first + i] += factor_ * layer[i].h;
        if (!gradients.empty()) gradients[first + i] += factor_ * Vec3(layer[i].hx, layer[i].hy, 0.0);
      }
    }
  }
  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval f = terrain_->bound(box);
    const Interval e = layer_.bound(Vec2(box.lo), Vec2(box.hi));
    return {f.lo + std::min(factor_ * e.lo, factor_ * e.hi), f.hi + std::max(factor_ * e.lo, factor_ * e.hi)};
  }
  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    return std::make_shared<DisplacedTerrain>(terrain_->narrow(box), layer_, factor_, box);
  }

 private:
  FieldPtr terrain_;
  RasterLayer layer_;
  double factor_;
  double lipschitz_ = 1.0;
};

/// What stands where no block does: bare rock where it is steep, else soil.
struct Bare {
  FieldPtr strata;
  Label soil;
  double cos_slope;  ///< Of the gentlest bare rock.

  [[nodiscard]] bool is_soil(const Vec3& up) const noexcept { return up.z > cos_slope * glm::length(up); }
};

/// The terrain where no block can be.
class BareTerrain final : public Field {
 public:
  BareTerrain(FieldPtr terrain, Bare bare) : terrain_(std::move(terrain)), bare_(std::move(bare)) {}

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    terrain_->values(points, values, gradients);
  }
  [[nodiscard]] double lipschitz() const noexcept override { return terrain_->lipschitz(); }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override { return terrain_->bound(box); }
  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    return std::make_shared<BareTerrain>(terrain_->narrow(box), bare_);
  }
  void labels(const Points& points, std::span<Label> labels) const noexcept override {
    bare_.strata->labels(points, labels);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (bare_.is_soil(terrain_->gradient(points[i]))) labels[i] = bare_.soil;
  }

 private:
  FieldPtr terrain_;
  Bare bare_;
};

/// Which of the three surfaces can be the field's somewhere in a box.
struct Contenders {
  bool clip = true, base = true, rock = true;
};

/// See rock_on_terrain. What is no contender is neither evaluated nor counted in the Lipschitz constant.
class RockOnTerrain final : public Field {
 public:
  RockOnTerrain(FieldPtr terrain, RockZone zone, FieldPtr rock, Bare bare, Contenders contenders, const Box& rectangle)
      : terrain_(std::move(terrain)),
        zone_(std::move(zone)),
        rock_(std::move(rock)),
        bare_(std::move(bare)),
        can_(contenders) {
    const Vec2 lo(rectangle.lo), hi(rectangle.hi);
    if (can_.base) lipschitz_ = terrain_->lipschitz() + zone_.recess.slope_bound(lo, hi);
    if (can_.clip) lipschitz_ = std::max(lipschitz_, terrain_->lipschitz() + zone_.advance.slope_bound(lo, hi));
    modulus_ = {lipschitz_, 0.0};
    if (!can_.rock) return;
    const Modulus rock_modulus = rock_->modulus();
    lipschitz_ = std::max(lipschitz_, rock_->lipschitz());
    modulus_ = {std::max(modulus_.slope, rock_modulus.slope), rock_modulus.slack};
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    std::ranges::fill(values, kInfinity);
    between(points, {}, values, gradients);
  }

  void between(const Points& points, std::span<const double> floors, std::span<double> values,
               std::span<Vec3> gradients) const noexcept override {
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t count = std::min(kChunk, points.size() - first);
      chunk(points.subspan(first, count), floors.empty() ? floors : floors.subspan(first, count),
            values.subspan(first, count), gradients.empty() ? gradients : gradients.subspan(first, count));
    }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  /// max and min change by no more than the largest change of an argument.
  [[nodiscard]] Modulus modulus() const noexcept override { return modulus_; }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override { return parts(box).whole; }

  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    const Parts p = parts(box);
    if (p.outside) return std::make_shared<BareTerrain>(terrain_->narrow(box), bare_);
    // min and max return one of their arguments: a contender that loses everywhere in the box is dropped to the bit.
    Contenders can = can_;
    can.rock = can_.rock && !(can_.base && p.rock.lo > p.base.hi);
    can.base = can_.base && !(can.rock && p.base.lo > p.rock.hi);
    can.clip = can_.clip && !(p.clip.hi < p.inner.lo);
    if (!can.base && !can.clip) return rock_->narrow(box);
    return std::make_shared<RockOnTerrain>(terrain_->narrow(box), zone_, can.rock ? rock_->narrow(box) : nullptr, bare_, can,
                                           box);
  }

  void labels(const Points& points, std::span<Label> labels) const noexcept override {
    bare_.strata->labels(points, labels);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points[i];
      const Heightfield::Sample recess = zone_.recess.at(p.x, p.y);
      const bool outside = recess.h <= 0.0 && zone_.advance.at(p.x, p.y).h <= 0.0;
      if (!outside && can_.rock && (!can_.base || rock_->value(p) < terrain_->value(p) + recess.h)) {
        rock_->labels(points.subspan(i, 1), labels.subspan(i, 1));
      } else {
        const Vec3 up = terrain_->gradient(p) + Vec3(recess.hx, recess.hy, 0.0);
        if (bare_.is_soil(up)) labels[i] = bare_.soil;
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
    const Interval recess = zone_.recess.bound(lo, hi);
    const Interval advance = zone_.advance.bound(lo, hi);
    const Interval f = terrain_->bound(box);
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

  void chunk(const Points& points, std::span<const double> floors, std::span<double> values,
             std::span<Vec3> gradients) const noexcept {
    const std::size_t n = points.size();
    const bool wants_gradients = !gradients.empty();
    std::array<double, kChunk> clip, inner;
    std::array<Vec3, kChunk> clip_gradients, inner_gradients;
    terrain_->values(points, {clip.data(), n}, {clip_gradients.data(), wants_gradients ? n : 0});
    std::array<Heightfield::Sample, kChunk> recess, advance;
    zone_.recess.at(points.x, points.y, std::span(recess).first(n));
    zone_.advance.at(points.x, points.y, std::span(advance).first(n));
    bool any = false;
    for (std::size_t i = 0; i < n; ++i) any = any || recess[i].h > 0.0 || advance[i].h > 0.0;
    const bool asks_rock = can_.rock && any, base_counts = can_.base || !any;
    for (std::size_t i = 0; i < n; ++i) {
      inner[i] = std::min(base_counts ? clip[i] + recess[i].h : kInfinity, values[i]);
      if (wants_gradients) {
        inner_gradients[i] = clip_gradients[i] + Vec3(recess[i].hx, recess[i].hy, 0.0);
        clip_gradients[i] -= Vec3(advance[i].hx, advance[i].hy, 0.0);
      }
      clip[i] = can_.clip ? clip[i] - advance[i].h : -kInfinity;
      if (!floors.empty()) clip[i] = std::max(clip[i], floors[i]);
    }
    // The blocks matter only where they are below the base and above the clip.
    if (asks_rock)
      rock_->between(points, {clip.data(), n}, {inner.data(), n}, {inner_gradients.data(), wants_gradients ? n : 0});
    for (std::size_t i = 0; i < n; ++i) {
      const double value = std::max(clip[i], inner[i]);
      if (value < values[i]) {
        values[i] = value;
        if (wants_gradients) gradients[i] = value > clip[i] ? inner_gradients[i] : clip_gradients[i];
      } else if (!floors.empty()) {
        values[i] = std::max(floors[i], values[i]);
      }
    }
  }

  FieldPtr terrain_;
  RockZone zone_;
  FieldPtr rock_;
  Bare bare_;
  Contenders can_;
  double lipschitz_ = 0.0;
  Modulus modulus_{0.0, 0.0};
};

}  // namespace

FieldPtr displaced_terrain(FieldPtr terrain, RasterLayer layer, double factor) {
  const Box rectangle = flat_box(layer.lo(), layer.hi());
  return std::make_shared<DisplacedTerrain>(std::move(terrain), std::move(layer), factor, rectangle);
}

FieldPtr rock_on_terrain(FieldPtr terrain, RockZone zone, FieldPtr rock, FieldPtr strata, Label ground) {
  const Box rectangle = flat_box(zone.recess.lo(), zone.recess.hi());
  Bare bare{std::move(strata), ground, std::cos(std::min(zone.slope + kBareSlope, 0.5 * kPi))};
  const Contenders contenders{.rock = rock != nullptr};
  return std::make_shared<RockOnTerrain>(std::move(terrain), std::move(zone), std::move(rock), std::move(bare), contenders,
                                         rectangle);
}

}  // namespace outcrop

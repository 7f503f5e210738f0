#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "each_position.h"
#include "outcrop/core/error.h"
#include "strata_parts.h"

namespace outcrop {
namespace {

constexpr double kDeep = 1e6;            // Metres: inside of what has no boundary.
constexpr double kSteepestFade = 1.5397;  // |d/du (1 − u²)²| at most, at u = 1/√3: 8 √3 / 9.
constexpr std::size_t kChunk = 768;      // Points at a time: a mesher's brick of 9³.

/// The heights at which a material begins and ends, and how far a height is from the nearest.
class HeightIntervals {
 public:
  HeightIntervals(const Strata& strata, Label material) {
    if (strata.layers.empty()) {
      inside_below_ = material == 0;
      return;
    }
    // Where layers repeat, a pile and its neighbours hold whatever is nearest to a height of the middle one.
    if (strata.base) {
      base_ = *strata.base;
      thickness_ = strata.layers.back().top - base_;
    }
    const int piles = strata.base ? 1 : 0;
    inside_below_ = strata.layers.front().material == material;
    bool inside = inside_below_;
    for (int pile = -piles; pile <= piles; ++pile)
      for (std::size_t i = 0; i < strata.layers.size(); ++i) {
        const bool now = strata.layers[i].material == material;
        const double bottom = i > 0 ? strata.layers[i - 1].top : base_;
        if (now != inside) borders_.push_back(bottom + pile * thickness_);
        inside = now;
      }
  }

  [[nodiscard]] bool everywhere() const noexcept { return borders_.empty() && inside_below_; }

  /// Signed, negative within.
  [[nodiscard]] double distance(double height) const noexcept {
    if (thickness_ > 0.0) height -= thickness_ * std::floor((height - base_) / thickness_);
    const auto above = std::ranges::upper_bound(borders_, height);
    double nearest = kDeep;
    if (above != borders_.end()) nearest = *above - height;
    if (above != borders_.begin()) nearest = std::min(nearest, height - *std::prev(above));
    const bool inside = inside_below_ != ((above - borders_.begin()) % 2 != 0);
    return inside ? -nearest : nearest;
  }

 private:
  std::vector<double> borders_;
  bool inside_below_ = false;
  double base_ = 0.0, thickness_ = 0.0;
};

class StratumBody final : public Field {
 public:
  StratumBody(const Strata& strata, Label material, const Strata::Limb& limb, double cap)
      : strata_(strata), intervals_(strata, material), limb_(limb), cap_(cap) {
    planar_ = 1.0 / std::hypot(1.0, std::tan(strata.dip));
    lipschitz_ = std::max(1.0, planar_ * std::hypot(1.0, terrain::steepest_bedding(strata)));
    for (const Fault& fault : strata.faults) lipschitz_ *= 1.0 + kSteepestFade * std::abs(fault.slip) / fault.extent;
    if (const RasterLayer* own = strata_.map.area(material)) own_ = *own;
    if (const RasterLayer* unnamed = strata_.map.area(std::nullopt)) unnamed_ = *unnamed;
    for (const auto& layer : {own_, unnamed_})
      if (layer) lipschitz_ = std::max(lipschitz_, layer->slope_bound(layer->lo(), layer->hi()));
    lipschitz_ *= 1.0 + 1e-9;
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t n = std::min(kChunk, points.size() - first);
      const Points p = points.subspan(first, n);
      std::array<double, kChunk> rise;
      if (strata_.faults.empty())
        terrain::each_position(p.x, p.y, std::span(rise).first(n),
                               [this](double x, double y) { return terrain::bedding_rise(strata_, {x, y}); });
      for (std::size_t i = 0; i < n; ++i)
        values[first + i] = strata_.faults.empty() ? mapped(p[i], unfaulted(p[i], rise[i])) : value_at(p[i]);
    }
    // Central differences: asked for where this is the surface, and there alone.
    for (std::size_t i = 0; i < gradients.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kStep = 1e-4;
        Vec3 ahead = points[i], behind = points[i];
        ahead[axis] += kStep;
        behind[axis] -= kStep;
        gradients[i][axis] = (value_at(ahead) - value_at(behind)) / (ahead[axis] - behind[axis]);
      }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval around = Field::bound(box);
    return {around.lo, std::min(around.hi, std::max(cap_, around.lo))};
  }

 private:
  [[nodiscard]] double value_at(const Vec3& p) const noexcept { return mapped(p, layered(p, strata_.faults.size())); }

  /// Before faults.
  [[nodiscard]] double unfaulted(const Vec3& p, double rise) const noexcept {
    double value = planar_ * intervals_.distance(p.z + rise);
    if (limb_.from > 0.0 || limb_.to < 1.0) {
      const double wavelength = strata_.fold.wavelength;
      const double turns = terrain::fold_phase(strata_, Vec2(p)) / wavelength;
      const double share = std::abs(turns - std::round(turns));
      const double below = limb_.from > 0.0 ? limb_.from - share : -1.0;
      value = std::max(value, wavelength * std::max(below, share - limb_.to));
    }
    return std::min(value, cap_);
  }

  /// After the first `faults` faults. The hanging wall's body ends at the disc that slipped, and so does the footwall's:
  /// each side's own value, no deeper than the disc is far, or the other's, no less than that; equal where the slip ends.
  [[nodiscard]] double layered(const Vec3& p, std::size_t faults) const noexcept {
    if (faults == 0) return unfaulted(p, terrain::bedding_rise(strata_, Vec2(p)));
    const Fault& fault = strata_.faults[faults - 1];
    const terrain::FaultPlace place = terrain::place_at(fault, p);
    const bool hanging = place.across > 0.0;
    const auto side = [&](bool up) { return layered(up ? terrain::unslipped(fault, p) : p, faults - 1); };
    const double own = std::max(-place.distance, side(hanging));
    return place.distance >= cap_ ? own : std::min(own, std::max(place.distance, side(!hanging)));
  }

  [[nodiscard]] double mapped(const Vec3& p, double value) const noexcept {
    if (strata_.map.empty()) return value;
    value = unnamed_ ? std::max(value, unnamed_->at(p.x, p.y).h) : cap_;
    if (own_) value = std::min(value, own_->at(p.x, p.y).h);
    return std::min(value, cap_);
  }

  Strata strata_;
  HeightIntervals intervals_;
  Strata::Limb limb_;
  double cap_;
  double planar_ = 1.0;  ///< Distance over vertical distance, where beds neither fold nor undulate.
  double lipschitz_ = 1.0;
  std::optional<RasterLayer> own_, unnamed_;
};

}  // namespace

FieldPtr stratum_body(const Strata& strata, Label material, const Strata::Limb& limb, double cap) {
  require(cap > 0.0, "cap", "> 0 m", cap);
  const bool whole = limb.from <= 0.0 && limb.to >= 1.0;
  if (whole && strata.faults.empty() && strata.map.empty() && HeightIntervals(strata, material).everywhere())
    return nullptr;
  return std::make_shared<StratumBody>(strata, material, limb, cap);
}

}  // namespace outcrop

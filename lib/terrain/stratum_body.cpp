#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "bedding.h"
#include "each_position.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

constexpr double kDeep = 1e6;        // Metres: inside of what has no boundary.
constexpr std::size_t kChunk = 768;  // Points at a time: a mesher's brick of 9³.

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
  StratumBody(const Strata& strata, Label material, const Strata::Limb& limb, double inside, double outside)
      : bedding_(strata),
        intervals_(strata, material),
        limb_(limb),
        wavelength_(strata.fold.wavelength),
        inside_(inside),
        outside_(outside) {
    planar_ = 1.0 / std::hypot(1.0, std::tan(strata.dip));
    lipschitz_ = std::max(1.0, planar_ * std::hypot(1.0, bedding_.steepest()));
    for (const Fault& fault : strata.faults) {
      faults_.emplace_back(fault);
      lipschitz_ *= faults_.back().stretch();
    }
    mapped_ = !strata.map.empty();
    if (const RasterLayer* own = strata.map.area(material)) own_ = *own;
    if (const RasterLayer* unnamed = strata.map.area(std::nullopt)) unnamed_ = *unnamed;
    for (const auto& layer : {own_, unnamed_})
      if (layer) lipschitz_ = std::max(lipschitz_, layer->slope_bound(layer->lo(), layer->hi()));
    lipschitz_ *= 1.0 + 1e-9;
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t n = std::min(kChunk, points.size() - first);
      chunk(points.subspan(first, n), values.subspan(first, n));
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
    const double reach = lipschitz_ * box.half_diagonal();
    const Vec3 centre = box.centre();
    // Far from boundaries the undulation need not be known.
    const double middle = plain() ? planar_distance(centre, bedding_.planar_rise(Vec2(centre))) : 0.0;
    const double slack = planar_ * bedding_.undulation() + reach;
    if (plain() && middle - slack >= outside_) return {outside_, outside_};
    if (plain() && middle + slack <= -inside_) return {-inside_, -inside_};
    const double value = value_at(centre);
    return {std::max(value - reach, -inside_), std::min(value + reach, outside_)};
  }

  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    if (!(bedding_.undulation() > 0.0)) return shared_from_this();
    auto narrowed = std::make_shared<StratumBody>(*this);
    narrowed->bedding_ = bedding_.near(Vec2(box.centre()));
    return narrowed;
  }

 private:
  /// Only layers: no limbs, faults or map.
  [[nodiscard]] bool plain() const noexcept {
    return faults_.empty() && !mapped_ && limb_.from <= 0.0 && limb_.to >= 1.0;
  }

  void chunk(const Points& points, std::span<double> values) const noexcept {
    if (!plain()) {
      for (std::size_t i = 0; i < points.size(); ++i) values[i] = value_at(points[i]);
      return;
    }
    std::array<double, kChunk> rise;
    const std::span<double> rises = std::span(rise).first(points.size());
    terrain::each_position(points.x, points.y, rises, [this](double x, double y) {
      return bedding_.planar_rise({x, y});
    });
    const double slack = planar_ * bedding_.undulation();
    bool decided = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double planar = planar_distance(points[i], rise[i]);
      decided = decided && (planar - slack >= outside_ || planar + slack <= -inside_);
      values[i] = clamped(planar);
    }
    if (decided) return;
    terrain::each_position(points.x, points.y, rises, [this](double x, double y) { return bedding_.rise({x, y}); });
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = clamped(planar_distance(points[i], rise[i]));
  }

  [[nodiscard]] double clamped(double value) const noexcept { return std::clamp(value, -inside_, outside_); }
  [[nodiscard]] double planar_distance(const Vec3& p, double rise) const noexcept {
    return planar_ * intervals_.distance(p.z + rise);
  }
  [[nodiscard]] double value_at(const Vec3& p) const noexcept { return clamped(mapped(p, faulted(p, faults_.size()))); }

  /// Before faults.
  [[nodiscard]] double unfaulted(const Vec3& p) const noexcept {
    const double value = planar_distance(p, bedding_.rise(Vec2(p)));
    if (limb_.from <= 0.0 && limb_.to >= 1.0) return value;
    const double turns = bedding_.across_fold(Vec2(p)) / wavelength_;
    const double share = std::abs(turns - std::round(turns));
    const double below = limb_.from > 0.0 ? limb_.from - share : -1.0;
    return std::max(value, wavelength_ * std::max(below, share - limb_.to));
  }

  /// After the first `faults` faults. The hanging wall's body ends at the disc that slipped, and so does the
  /// footwall's: each side's own value, no deeper than the disc is far, or the other's, no less than that; equal where
  /// the slip ends.
  [[nodiscard]] double faulted(const Vec3& p, std::size_t faults) const noexcept {
    if (faults == 0) return unfaulted(p);
    const terrain::FaultPlane& fault = faults_[faults - 1];
    const terrain::FaultPlane::Place place = fault.place(p);
    const bool hanging = place.across > 0.0;
    const auto side = [&](bool up) { return faulted(up ? fault.unslipped(p) : p, faults - 1); };
    const double own = std::max(-place.distance, side(hanging));
    // What is above `outside` ends there.
    return place.distance >= outside_ ? own : std::min(own, std::max(place.distance, side(!hanging)));
  }

  [[nodiscard]] double mapped(const Vec3& p, double value) const noexcept {
    if (!mapped_) return value;
    value = unnamed_ ? std::max(value, unnamed_->at(p.x, p.y).h) : outside_;
    return own_ ? std::min(value, own_->at(p.x, p.y).h) : value;
  }

  terrain::Bedding bedding_;
  std::vector<terrain::FaultPlane> faults_;
  HeightIntervals intervals_;
  Strata::Limb limb_;
  double wavelength_;        ///< Of the folds.
  double inside_, outside_;  ///< Values beyond are clamped.
  double planar_ = 1.0;      ///< Distance over vertical distance, where beds neither fold nor undulate.
  double lipschitz_ = 1.0;
  bool mapped_ = false;
  std::optional<RasterLayer> own_, unnamed_;
};

}  // namespace

FieldPtr stratum_body(const Strata& strata, Label material, const Strata::Limb& limb, double inside, double outside) {
  require(inside > 0.0, "inside", "> 0 m", inside);
  require(outside > 0.0, "outside", "> 0 m", outside);
  const bool whole = limb.from <= 0.0 && limb.to >= 1.0;
  if (whole && strata.faults.empty() && strata.map.empty() && HeightIntervals(strata, material).everywhere())
    return nullptr;
  return std::make_shared<StratumBody>(strata, material, limb, inside, outside);
}

}  // namespace outcrop

#include "outcrop/terrain/strata.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "bedding.h"

namespace outcrop {
namespace {

constexpr double kDipStep = radians(12.0);  // Between limbs of a fold, at most: half of it from the bedding.

Mat3 rotation_to_bedding(double dip, double dip_direction) noexcept {
  // A turn by the dip around the strike, which lies a quarter turn left of the dip direction and stays where it is.
  const Vec2 d = terrain::towards(dip_direction);
  const Vec3 strike(-d.y, d.x, 0.0);
  const double c = std::cos(dip), s = std::sin(dip);
  const auto turned = [&](const Vec3& v) {
    return v * c + glm::cross(strike, v) * s + strike * (glm::dot(strike, v) * (1.0 - c));
  };
  return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})};
}

/// Bed of a height, counted from the bottom layer: beyond the first pile where the layers repeat.
struct Bed {
  double pile;
  std::size_t layer;
  friend bool operator==(const Bed&, const Bed&) = default;
};

Bed bed_at(const Strata& strata, double height) noexcept {
  const auto last = std::prev(strata.layers.end());
  double pile = 0.0;
  if (strata.base) {
    const double thickness = last->top - *strata.base;
    pile = std::floor((height - *strata.base) / thickness);
    height -= pile * thickness;
  }
  const auto layer = std::find_if(strata.layers.begin(), last, [&](const Stratum& s) { return height < s.top; });
  return {pile, static_cast<std::size_t>(layer - strata.layers.begin())};
}

/// Where the rock at p was before the faults.
Vec3 unfaulted(const Strata& strata, Vec3 p) noexcept {
  for (std::size_t k = strata.faults.size(); k-- > 0;) {
    const terrain::FaultPlane plane(strata.faults[k]);
    if (plane.place(p).across > 0.0) p = plane.unslipped(p);
  }
  return p;
}

}  // namespace

double Strata::stratigraphic_height(const Vec3& p) const noexcept {
  const Vec3 q = unfaulted(*this, p);
  return q.z + terrain::Bedding(*this).rise(Vec2(q));
}

Label Strata::material(const Vec3& p) const noexcept {
  if (const std::optional<Label> mapped = map.at(p.x, p.y)) return *mapped;
  if (layers.empty()) return 0;
  const Vec3 q = unfaulted(*this, p);
  // Most points are so far from any boundary that the noise, which is dear and stays within ±1, cannot matter.
  const terrain::Bedding bedding(*this);
  const double rise = bedding.planar_rise(Vec2(q)), planar = q.z + rise;
  const Bed lowest = bed_at(*this, planar - undulation);
  if (bed_at(*this, planar + undulation) == lowest) return layers[lowest.layer].material;
  return layers[bed_at(*this, q.z + bedding.undulated(rise, Vec2(q))).layer].material;
}

Mat3 Strata::world_from_bedding() const noexcept { return rotation_to_bedding(dip, dip_direction); }

std::vector<Strata::Limb> Strata::limbs() const {
  if (!(fold.amplitude > 0.0)) return {{.world_from_bedding = world_from_bedding()}};
  const double steepest = 2.0 * kPi * fold.amplitude / fold.wavelength;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::atan(steepest) / kDipStep)));
  // Shares of the wavelength at which the slope of the fold passes the middles between the limbs' dips.
  const auto share_at = [&](double angle) {
    return std::acos(std::clamp(std::tan(angle) / steepest, -1.0, 1.0)) / (2.0 * kPi);
  };
  const double step = std::atan(steepest) / steps;
  const Vec2 across(std::cos(fold.axis), -std::sin(fold.axis));
  std::vector<Limb> result;
  for (int k = steps; k >= -steps; --k) {
    const Vec2 fall = std::tan(dip) * terrain::towards(dip_direction) - std::tan(k * step) * across;
    const double turned = std::atan(glm::length(fall));
    result.push_back({.world_from_bedding = rotation_to_bedding(turned, std::atan2(fall.x, fall.y)),
                      .from = k == steps ? 0.0 : result.back().to,
                      .to = k == -steps ? 1.0 : share_at((k - 0.5) * step)});
  }
  return result;
}

}  // namespace outcrop

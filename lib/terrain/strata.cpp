#include "outcrop/terrain/strata.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "outcrop/core/rng.h"
#include "strata_parts.h"

namespace outcrop {
namespace {

constexpr int kOctaves = 3;                            // Beds bend at the wavelength, its half and its quarter.
constexpr double kGain = 0.5;                          // Amplitude from octave to octave.
constexpr double kLargestNoise = 0.70710678118654752;  // Of gradient noise with unit gradients in two dimensions: √½.
constexpr double kDipStep = radians(12.0);             // Between limbs of a fold, at most: half of it from the bedding.

// The slope of one octave of that noise n = Σ w_ab (g_ab · (p − ab)) is at most 1, of the convex sum of unit gradients,
// and along each axis 15/8, the fade's largest slope, times the difference of two corners' terms, √2 at most in the
// middle of the cell: together 1 + √2 · 15/8 · √2. Octaves double the frequency and halve the amplitude.
constexpr double kSteepestOctave = 1.0 + 2.0 * 15.0 / 8.0;
constexpr double kSteepestNoise = kSteepestOctave * kOctaves / ((2.0 - 0.25) * kLargestNoise);

/// The way a bed dips: a horizontal unit vector.
Vec2 dip_vector(double dip_direction) noexcept { return {std::sin(dip_direction), std::cos(dip_direction)}; }

/// The unit gradient at a lattice point, one of eight.
Vec2 lattice_gradient(std::uint64_t seed, int octave, std::int64_t i, std::int64_t j) noexcept {
  constexpr double kDiagonal = 0.70710678118654752;
  constexpr std::array<std::array<double, 2>, 8> kDirections{{{1, 0},
                                                              {kDiagonal, kDiagonal},
                                                              {0, 1},
                                                              {-kDiagonal, kDiagonal},
                                                              {-1, 0},
                                                              {-kDiagonal, -kDiagonal},
                                                              {0, -1},
                                                              {kDiagonal, -kDiagonal}}};
  constexpr std::uint64_t kRow = 0x9E3779B97F4A7C15ull;  // Odd: (i, j) pairs of a terrain get different indices.
  const std::uint64_t index =
      (static_cast<std::uint64_t>(j) * kRow + static_cast<std::uint64_t>(i)) * kOctaves + octave;
  const auto& d = kDirections[Rng(seed, "undulation", index).next() >> 61];
  return {d[0], d[1]};
}

/// Gradient noise (Perlin 2002: quintic fade, so C²), 0 at lattice points, |n| ≤ √½.
double gradient_noise(std::uint64_t seed, int octave, const Vec2& p) noexcept {
  const double fx = std::floor(p.x), fy = std::floor(p.y);
  const auto i = static_cast<std::int64_t>(fx), j = static_cast<std::int64_t>(fy);
  const double u = p.x - fx, v = p.y - fy;
  const auto corner = [&](int a, int b) {
    return glm::dot(lattice_gradient(seed, octave, i + a, j + b), Vec2(u - a, v - b));
  };
  const auto fade = [](double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); };
  return glm::mix(glm::mix(corner(0, 0), corner(1, 0), fade(u)), glm::mix(corner(0, 1), corner(1, 1), fade(u)),
                  fade(v));
}

/// Octaves of it, scaled so that |n| ≤ 1.
double undulation_noise(std::uint64_t seed, Vec2 p) noexcept {
  constexpr double kLargestPosition = 1e15;  // Lattice indices fit their type; nobody's map is that large.
  p = glm::clamp(p, Vec2(-kLargestPosition), Vec2(kLargestPosition));
  double sum = 0.0, gain = 1.0, total = 0.0;
  for (int octave = 0; octave < kOctaves; ++octave) {
    sum += gain * gradient_noise(seed, octave, p);
    total += gain;
    gain *= kGain;
    p *= 2.0;
  }
  return sum / (total * kLargestNoise);
}

Mat3 rotation_to_bedding(double dip, double dip_direction) noexcept {
  // A turn by the dip around the strike, which lies a quarter turn left of the dip direction and stays where it is.
  const Vec2 d = dip_vector(dip_direction);
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

}  // namespace

namespace terrain {

double fold_phase(const Strata& strata, const Vec2& p) noexcept {
  const Vec2 across(std::cos(strata.fold.axis), -std::sin(strata.fold.axis));
  return glm::dot(p - strata.reference, across);
}

double planar_rise(const Strata& strata, const Vec2& p) noexcept {
  double rise = std::tan(strata.dip) * glm::dot(p - strata.reference, dip_vector(strata.dip_direction));
  const Fold& fold = strata.fold;
  if (fold.amplitude > 0.0)
    rise -= fold.amplitude * std::sin(2.0 * kPi / fold.wavelength * fold_phase(strata, p));
  return rise;
}

double bedding_rise(const Strata& strata, const Vec2& p) noexcept {
  const double rise = planar_rise(strata, p);
  if (!(strata.undulation > 0.0)) return rise;
  return rise -
         strata.undulation * undulation_noise(strata.seed, (p - strata.reference) / strata.undulation_wavelength);
}

double steepest_bedding(const Strata& strata) noexcept {
  return std::tan(strata.dip) + 2.0 * kPi * strata.fold.amplitude / strata.fold.wavelength +
         kSteepestNoise * strata.undulation / strata.undulation_wavelength;
}

FaultPlace place_at(const Fault& fault, const Vec3& p) noexcept {
  const Vec3 normal(std::sin(fault.dip) * dip_vector(fault.dip_direction), std::cos(fault.dip));
  const Vec3 offset = p - fault.point;
  const double across = glm::dot(normal, offset);
  const double along = glm::length(offset - across * normal);
  return {across, std::hypot(across, std::max(along - fault.extent, 0.0))};
}

Vec3 unslipped(const Fault& fault, const Vec3& p) noexcept {
  const double share = glm::length(p - fault.point) / fault.extent;
  if (share >= 1.0) return p;
  const double fade = 1.0 - share * share;
  const Vec3 down(std::cos(fault.dip) * dip_vector(fault.dip_direction), -std::sin(fault.dip));
  return p - fault.slip * fade * fade * down;
}

}  // namespace terrain

namespace {

/// Where the rock at p was before the faults.
Vec3 unfaulted(const Strata& strata, Vec3 p) noexcept {
  for (std::size_t k = strata.faults.size(); k-- > 0;)
    if (terrain::place_at(strata.faults[k], p).across > 0.0) p = terrain::unslipped(strata.faults[k], p);
  return p;
}

}  // namespace

double Strata::stratigraphic_height(const Vec3& p) const noexcept {
  const Vec3 q = unfaulted(*this, p);
  return q.z + terrain::bedding_rise(*this, Vec2(q));
}

Label Strata::material(const Vec3& p) const noexcept {
  if (const std::optional<Label> mapped = map.at(p.x, p.y)) return *mapped;
  if (layers.empty()) return 0;
  const Vec3 q = unfaulted(*this, p);
  // Most points are so far from any boundary that the noise, which is dear and stays within ±1, cannot matter.
  const double planar = q.z + terrain::planar_rise(*this, Vec2(q));
  const Bed lowest = bed_at(*this, planar - undulation);
  if (bed_at(*this, planar + undulation) == lowest) return layers[lowest.layer].material;
  return layers[bed_at(*this, q.z + terrain::bedding_rise(*this, Vec2(q))).layer].material;
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
    const Vec2 fall = std::tan(dip) * dip_vector(dip_direction) - std::tan(k * step) * across;
    const double turned = std::atan(glm::length(fall));
    result.push_back({.world_from_bedding = rotation_to_bedding(turned, std::atan2(fall.x, fall.y)),
                      .from = k == steps ? 0.0 : result.back().to,
                      .to = k == -steps ? 1.0 : share_at((k - 0.5) * step)});
  }
  return result;
}

}  // namespace outcrop

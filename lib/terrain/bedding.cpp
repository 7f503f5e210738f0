#include "bedding.h"

#include <algorithm>
#include <cmath>

#include "outcrop/core/rng.h"

namespace outcrop::terrain {
namespace {

constexpr double kGain = 0.5;                          // Amplitude from octave to octave.
constexpr double kLargestNoise = 0.70710678118654752;  // Of gradient noise with unit gradients in two dimensions: √½.
constexpr double kLargestPosition = 1e15;              // Lattice indices fit their type; nobody's map is that large.

// The slope of one octave n = Σ w_ab (g_ab · (p − ab)) is at most 1, of the convex sum of unit gradients, and along
// each axis 15/8, the fade's largest slope, times the difference of two corners' terms, √2 at most in the middle of the
// square: together 1 + √2 · 15/8 · √2.
constexpr double kSteepestOctave = 1.0 + 2.0 * 15.0 / 8.0;

constexpr double kSteepestFade = 1.5397;  // |d/du (1 − u²)²| at most, at u = 1/√3: 8 √3 / 9.

/// The unit gradient at a lattice point, one of eight.
Vec2 lattice_gradient(std::uint64_t seed, int octaves, int octave, std::int64_t i, std::int64_t j) noexcept {
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
  const std::uint64_t index = (static_cast<std::uint64_t>(j) * kRow + static_cast<std::uint64_t>(i)) * octaves + octave;
  const auto& d = kDirections[Rng(seed, "undulation", index).next() >> 61];
  return {d[0], d[1]};
}

Vec2 on_lattice(const Vec2& p) noexcept { return glm::clamp(p, Vec2(-kLargestPosition), Vec2(kLargestPosition)); }

}  // namespace

Vec2 towards(double azimuth) noexcept { return {std::sin(azimuth), std::cos(azimuth)}; }

UndulationNoise::Square UndulationNoise::square(int octave, const Vec2& p) const noexcept {
  Square square{static_cast<std::int64_t>(std::floor(p.x)), static_cast<std::int64_t>(std::floor(p.y)), {}};
  for (int corner = 0; corner < 4; ++corner)
    square.gradients[corner] = lattice_gradient(seed_, kOctaves, octave, square.i + corner % 2, square.j + corner / 2);
  return square;
}

double UndulationNoise::at(Vec2 p) const noexcept {
  const auto fade = [](double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); };
  p = on_lattice(p);
  double sum = 0.0, gain = 1.0, total = 0.0;
  for (int octave = 0; octave < kOctaves; ++octave) {
    const double fx = std::floor(p.x), fy = std::floor(p.y);
    const double u = p.x - fx, v = p.y - fy;
    const auto value = [&](const Square& square) {
      const auto corner = [&](int a, int b) { return glm::dot(square.gradients[2 * b + a], Vec2(u - a, v - b)); };
      return glm::mix(glm::mix(corner(0, 0), corner(1, 0), fade(u)), glm::mix(corner(0, 1), corner(1, 1), fade(u)),
                      fade(v));
    };
    const Square* const known = known_ ? &(*known_)[octave] : nullptr;
    const bool here = known && static_cast<double>(known->i) == fx && static_cast<double>(known->j) == fy;
    sum += gain * value(here ? *known : square(octave, p));
    total += gain;
    gain *= kGain;
    p *= 2.0;
  }
  return sum / (total * kLargestNoise);
}

UndulationNoise UndulationNoise::near(Vec2 p) const noexcept {
  UndulationNoise result(seed_);
  result.known_.emplace();
  p = on_lattice(p);
  for (int octave = 0; octave < kOctaves; ++octave, p *= 2.0) (*result.known_)[octave] = square(octave, p);
  return result;
}

double UndulationNoise::steepest() noexcept {
  // Octaves double the frequency and halve the amplitude.
  return kSteepestOctave * kOctaves / ((2.0 - 0.25) * kLargestNoise);
}

Bedding::Bedding(const Strata& strata) noexcept
    : reference_(strata.reference),
      slope_(std::tan(strata.dip) * towards(strata.dip_direction)),
      amplitude_(strata.fold.amplitude),
      undulation_(strata.undulation),
      wavelength_(strata.undulation_wavelength),
      noise_(strata.seed) {
  if (!(amplitude_ > 0.0)) return;
  across_ = {std::cos(strata.fold.axis), -std::sin(strata.fold.axis)};
  turns_ = 2.0 * kPi / strata.fold.wavelength;
}

double Bedding::across_fold(const Vec2& p) const noexcept { return glm::dot(p - reference_, across_); }

double Bedding::planar_rise(const Vec2& p) const noexcept {
  const double rise = glm::dot(p - reference_, slope_);
  return amplitude_ > 0.0 ? rise - amplitude_ * std::sin(turns_ * across_fold(p)) : rise;
}

double Bedding::undulated(double planar_rise, const Vec2& p) const noexcept {
  return undulation_ > 0.0 ? planar_rise - undulation_ * noise_.at((p - reference_) / wavelength_) : planar_rise;
}

double Bedding::steepest() const noexcept {
  return glm::length(slope_) + turns_ * amplitude_ + UndulationNoise::steepest() * undulation_ / wavelength_;
}

Bedding Bedding::near(const Vec2& p) const noexcept {
  Bedding result = *this;
  if (undulation_ > 0.0) result.noise_ = noise_.near((p - reference_) / wavelength_);
  return result;
}

FaultPlane::FaultPlane(const Fault& fault) noexcept
    : point_(fault.point),
      normal_(std::sin(fault.dip) * towards(fault.dip_direction), std::cos(fault.dip)),
      slip_(fault.slip * Vec3(std::cos(fault.dip) * towards(fault.dip_direction), -std::sin(fault.dip))),
      extent_(fault.extent) {}

FaultPlane::Place FaultPlane::place(const Vec3& p) const noexcept {
  const Vec3 offset = p - point_;
  const double across = glm::dot(normal_, offset);
  const double along = glm::length(offset - across * normal_);
  return {across, std::hypot(across, std::max(along - extent_, 0.0))};
}

Vec3 FaultPlane::unslipped(const Vec3& p) const noexcept {
  const double share = glm::length(p - point_) / extent_;
  if (share >= 1.0) return p;
  const double fade = 1.0 - share * share;
  return p - fade * fade * slip_;
}

double FaultPlane::stretch() const noexcept { return 1.0 + kSteepestFade * glm::length(slip_) / extent_; }

}  // namespace outcrop::terrain

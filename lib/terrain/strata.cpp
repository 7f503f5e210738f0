#include "outcrop/terrain/strata.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

constexpr int kOctaves = 3;                            // Beds bend at the wavelength, its half and its quarter.
constexpr double kGain = 0.5;                          // Amplitude from octave to octave.
constexpr double kLargestNoise = 0.70710678118654752;  // Of gradient noise with unit gradients in two dimensions: √½.

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

}  // namespace

double Strata::planar_height(const Vec3& p) const noexcept {
  return p.z + std::tan(dip) * glm::dot(Vec2(p.x, p.y) - reference, dip_vector(dip_direction));
}

double Strata::stratigraphic_height(const Vec3& p) const noexcept {
  const double height = planar_height(p);
  if (!(undulation > 0.0)) return height;
  return height - undulation * undulation_noise(seed, (Vec2(p.x, p.y) - reference) / undulation_wavelength);
}

Label Strata::material(const Vec3& p) const noexcept {
  if (layers.empty()) return 0;
  const auto last = std::prev(layers.end());
  const auto layer_at = [&](double height) {
    return std::find_if(layers.begin(), last, [&](const Stratum& s) { return height < s.top; });
  };
  // Most points are so far from any boundary that the noise, which is dear and stays within ±1, cannot matter.
  const double planar = planar_height(p);
  const auto lowest = layer_at(planar - undulation);
  if (layer_at(planar + undulation) == lowest) return lowest->material;
  return layer_at(stratigraphic_height(p))->material;
}

Mat3 Strata::world_from_bedding() const noexcept {
  // A turn by the dip around the strike, which lies a quarter turn left of the dip direction and stays where it is.
  const Vec2 d = dip_vector(dip_direction);
  const Vec3 strike(-d.y, d.x, 0.0);
  const double c = std::cos(dip), s = std::sin(dip);
  const auto turned = [&](const Vec3& v) {
    return v * c + glm::cross(strike, v) * s + strike * (glm::dot(strike, v) * (1.0 - c));
  };
  return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})};
}

}  // namespace outcrop

/// How beds lie, fold, undulate and are displaced: Strata with its sines and tangents at hand.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "outcrop/terrain/strata.h"

namespace outcrop::terrain {

/// A horizontal unit vector towards an azimuth, radians clockwise from north.
[[nodiscard]] Vec2 towards(double azimuth) noexcept;

/// Gradient noise of three octaves with |n| ≤ 1, 0 at lattice points. Method: Perlin 2002, quintic fade, so C².
class UndulationNoise {
 public:
  explicit UndulationNoise(std::uint64_t seed) : seed_(seed) {}
  [[nodiscard]] double at(Vec2 p) const noexcept;
  /// The same to the bit, several times as fast about p.
  [[nodiscard]] UndulationNoise near(Vec2 p) const noexcept;
  /// ≥ the gradient's length.
  [[nodiscard]] static double steepest() noexcept;

 private:
  static constexpr int kOctaves = 3;  ///< Beds bend at the wavelength, its half and its quarter.
  /// A lattice square and the unit gradients at its corners: west to east, then from south to north.
  struct Square {
    std::int64_t i = 0, j = 0;
    std::array<Vec2, 4> gradients{};
  };
  [[nodiscard]] Square square(int octave, const Vec2& p) const noexcept;

  std::uint64_t seed_;
  std::optional<std::array<Square, kOctaves>> known_;
};

/// Beds before faults.
class Bedding {
 public:
  explicit Bedding(const Strata& strata) noexcept;

  /// Signed horizontal distance from the reference point across the fold's axis, metres.
  [[nodiscard]] double across_fold(const Vec2& p) const noexcept;
  /// Stratigraphic height minus elevation, without the undulation and with it; they differ by at most `undulation()`.
  [[nodiscard]] double planar_rise(const Vec2& p) const noexcept;
  [[nodiscard]] double rise(const Vec2& p) const noexcept { return undulated(planar_rise(p), p); }
  /// rise(p), given planar_rise(p).
  [[nodiscard]] double undulated(double planar_rise, const Vec2& p) const noexcept;
  [[nodiscard]] double undulation() const noexcept { return undulation_; }
  /// ≥ the gradient of the rise.
  [[nodiscard]] double steepest() const noexcept;
  /// The same to the bit, faster about p.
  [[nodiscard]] Bedding near(const Vec2& p) const noexcept;

 private:
  Vec2 reference_, slope_, across_{0.0};
  double amplitude_, turns_ = 0.0;  ///< Radians a metre across the fold.
  double undulation_, wavelength_;
  UndulationNoise noise_;
};

/// One fault's geometry.
class FaultPlane {
 public:
  explicit FaultPlane(const Fault& fault) noexcept;

  struct Place {
    double across;    ///< Signed distance to the plane: > 0 in the hanging wall.
    double distance;  ///< To the disc that slipped, ≥ |across|.
  };
  [[nodiscard]] Place place(const Vec3& p) const noexcept;
  /// Where p was before the slip, if it is in the hanging wall.
  [[nodiscard]] Vec3 unslipped(const Vec3& p) const noexcept;
  /// ≥ 1 and the Lipschitz constant of unslipped().
  [[nodiscard]] double stretch() const noexcept;

 private:
  Vec3 point_, normal_, slip_;
  double extent_;
};

}  // namespace outcrop::terrain

/// Layers of rock: which material stands where.
#pragma once

#include <vector>

#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"

namespace outcrop {

/// One layer, bottom to top in a Strata.
struct Stratum {
  Label material = 0;
  double top = 0.0;  ///< Elevation of the upper boundary at the reference point, metres; the last stratum's is ignored.
};

/// A pile of layers with common dip and a gentle undulation.
///
/// The boundary through elevation e is the plane of the given dip and dip direction (clockwise from north) through
/// (reference.x, reference.y, e), moved vertically by undulation · a C² noise of three octaves, the longest of the
/// given wavelength. The noise stays within ±1, has a root mean square of 0.2 and is 0 at the reference point.
struct Strata {
  std::vector<Stratum> layers;         ///< Bottom to top, tops ascending; empty: material 0 everywhere.
  double dip = 0.0;                    ///< Radians, [0, π/2).
  double dip_direction = 0.0;          ///< Radians, clockwise from north.
  double undulation = 0.0;             ///< Metres, ≥ 0.
  double undulation_wavelength = 100;  ///< Metres, > 0.
  Vec2 reference{0.0};                 ///< Map position where `top` holds.
  std::uint64_t seed = 1;

  /// Elevation of p along the bedding, back at the reference point: what is compared with Stratum::top.
  [[nodiscard]] double stratigraphic_height(const Vec3& p) const noexcept;
  [[nodiscard]] Label material(const Vec3& p) const noexcept;
  /// The rotation that carries the horizontal onto the bedding plane.
  [[nodiscard]] Mat3 world_from_bedding() const noexcept;

 private:
  /// Without the undulation.
  [[nodiscard]] double planar_height(const Vec3& p) const noexcept;
};

}  // namespace outcrop

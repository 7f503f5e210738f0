/// Layers of rock: which material stands where.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"
#include "outcrop/terrain/material_map.h"

namespace outcrop {

/// One layer, bottom to top in a Strata.
struct Stratum {
  Label material = 0;
  double top = 0.0;  ///< Elevation of the upper boundary at the reference point, metres; the last stratum's is ignored.
};

/// Cylindrical folds of similar shape: boundaries move vertically by amplitude · sin(2π s / wavelength), with s the
/// horizontal distance from the reference point, across the axis to its right.
struct Fold {
  double amplitude = 0.0;     ///< Metres, ≥ 0; 0: none.
  double wavelength = 100.0;  ///< Metres, > 0.
  double axis = 0.0;          ///< Azimuth of the fold axis, radians clockwise from north.
};

/// A plane along which rock has slipped: its hanging wall lies `slip` metres further down the dip than its footwall.
struct Fault {
  Vec3 point{0.0};             ///< On the plane, map position and elevation; the slip is largest here.
  double dip = 0.0;            ///< Radians, (0, π/2].
  double dip_direction = 0.0;  ///< Radians, clockwise from north: the hanging wall's side.
  double slip = 0.0;           ///< Metres: > 0 a normal fault, < 0 a reverse one.
  /// Radius of the disc that slipped, metres, > 0 and ≥ 2 |slip|: the displacement is slip · (1 − r²/extent²)², r being
  /// the distance to the point.
  double extent = std::numeric_limits<double>::infinity();
};

/// A pile of layers with common dip, a gentle undulation, folds and faults.
///
/// Before faults move it, the boundary through elevation e is the plane of the given dip and dip direction (clockwise
/// from north) through (reference.x, reference.y, e), moved vertically by the fold and by undulation · a C² noise of
/// three octaves, the longest of the given wavelength. The noise stays within ±1, has a root mean square of 0.2 and is
/// 0 at the reference point.
struct Strata {
  std::vector<Stratum> layers;         ///< Bottom to top, tops ascending; empty: material 0 everywhere.
  std::optional<double> base;          ///< Given: the layers from here to the last top repeat, upwards and downwards.
  double dip = 0.0;                    ///< Radians, [0, π/2).
  double dip_direction = 0.0;          ///< Radians, clockwise from north.
  double undulation = 0.0;             ///< Metres, ≥ 0.
  double undulation_wavelength = 100;  ///< Metres, > 0.
  Fold fold;
  std::vector<Fault> faults;  ///< From old to young: the later cut and move the earlier.
  MaterialMap map;            ///< Where it names a material, that one stands at all depths.
  Vec2 reference{0.0};        ///< Map position where `top` holds.
  std::uint64_t seed = 1;

  /// Elevation of p along the bedding, back at the reference point: what is compared with Stratum::top. Steps at
  /// faults.
  [[nodiscard]] double stratigraphic_height(const Vec3& p) const noexcept;
  [[nodiscard]] Label material(const Vec3& p) const noexcept;
  /// The rotation that carries the horizontal onto the bedding plane, folds and undulation aside.
  [[nodiscard]] Mat3 world_from_bedding() const noexcept;

  /// Parts of the folds, between vertical planes along the axis, within which the bedding keeps its dip to some
  /// degrees: what one lattice of blocks can be aligned with. One without folds. Several parts of each wavelength may
  /// be alike.
  struct Limb {
    Mat3 world_from_bedding{1.0};
    /// Shares of the wavelength: distances from where the boundaries rise steepest, at most ½ on both sides.
    double from = 0.0, to = 1.0;
  };
  [[nodiscard]] std::vector<Limb> limbs() const;
};

/// The rock of one material in one limb: the part of space where strata.material() is `material`, as a field.
///
/// Negative inside, continuous, 0 on boundaries of layers, on faults and between limbs: blocks that end at it are
/// bounded by bedding joints. Along planar beds and across faults it is the distance to the boundary, where beds fold
/// or undulate that distance to within the change of their slope. Clamped to [−inside, outside], both > 0 m. Null when
/// it would be all of space.
[[nodiscard]] FieldPtr stratum_body(const Strata& strata, Label material, const Strata::Limb& limb, double inside,
                                    double outside);

}  // namespace outcrop

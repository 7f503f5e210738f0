/// What Strata and the fields of its bodies share.
#pragma once

#include "outcrop/terrain/strata.h"

namespace outcrop::terrain {

/// Signed horizontal distance from the reference point across the fold's axis, metres.
[[nodiscard]] double fold_phase(const Strata& strata, const Vec2& p) noexcept;
/// Stratigraphic height minus elevation, faults aside, without the undulation and with it.
[[nodiscard]] double planar_rise(const Strata& strata, const Vec2& p) noexcept;
[[nodiscard]] double bedding_rise(const Strata& strata, const Vec2& p) noexcept;
/// ≥ the gradient of bedding_rise.
[[nodiscard]] double steepest_bedding(const Strata& strata) noexcept;

struct FaultPlace {
  double across;    ///< Signed distance to the plane: > 0 in the hanging wall.
  double distance;  ///< To the disc that slipped, ≥ |across|.
};
[[nodiscard]] FaultPlace place_at(const Fault& fault, const Vec3& p) noexcept;
/// Where p was before the slip, if it is in the hanging wall.
[[nodiscard]] Vec3 unslipped(const Fault& fault, const Vec3& p) noexcept;

}  // namespace outcrop::terrain

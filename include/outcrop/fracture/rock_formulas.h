/// What engineering geology computes from joint spacings: block volumes, Jv, RQD, and the classes of each.
#pragma once

#include <array>
#include <string_view>

#include "outcrop/core/vec.h"

namespace outcrop {

/// The volume of the blocks that three persistent joint sets cut out: S₁ S₂ S₃ / |n₁ · (n₂ × n₃)|, exact for any
/// angles; infinite when the normals lie in a plane. (The common form with the product of three sines is exact only
/// when two of the angles between the sets are right: at three angles of 60° it is 9 % too large, at 45° 29 %.)
/// @param spacings  Normal to each set, metres, > 0. @param normals  Unit.
[[nodiscard]] double block_volume(const std::array<double, 3>& spacings, const std::array<Vec3, 3>& normals) noexcept;

/// β of Vb = β Jv⁻³ for three sets at right angles: (a₂ + a₂a₃ + a₃)³ / (a₂a₃)² with a₂ = S₂/S₁, a₃ = S₃/S₁. 27 for a
/// cube, its least. The order of the spacings does not matter. @cite palmstrom_2005
/// @param spacings  Or edges of a block, metres, > 0.
[[nodiscard]] double block_shape_factor(const std::array<double, 3>& spacings) noexcept;

/// Rock quality designation from the volumetric joint count (per metre), percent: 110 − 2.5 Jv, in [0, 100].
/// @cite palmstrom_2005
[[nodiscard]] double rqd_2005(double jv) noexcept;
/// The older 115 − 3.3 Jv, in [0, 100]. @cite palmstrom_1982
[[nodiscard]] double rqd_1982(double jv) noexcept;
/// Of a line that meets λ joints a metre at random places: 100 e^(−0.1 λ) (0.1 λ + 1), percent. @cite priest_1976
[[nodiscard]] double rqd_priest_hudson(double joints_per_metre) noexcept;

/// Block size by Jv, per metre: "very large", "large", "medium", "small", "very small". @cite isrm_1978
[[nodiscard]] std::string_view jv_class(double jv) noexcept;
/// Block size by volume, m³: "extremely small", "very small", "small", "moderate", "large", "very large".
/// @cite palmstrom_1995
[[nodiscard]] std::string_view volume_class(double volume) noexcept;
/// Block shape by β: "equidimensional", "slightly long or flat", "moderately long or flat", "long or flat", "very long
/// or flat". @cite palmstrom_1995
[[nodiscard]] std::string_view shape_class(double beta) noexcept;

}  // namespace outcrop

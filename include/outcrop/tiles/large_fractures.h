/// Master joints and faults: fractures much larger than a tile, that run through terrain and tiles alike.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/core/rng.h"
#include "outcrop/implicit/field.h"

namespace outcrop {

/// A disc along which rock has opened, slipped or both.
struct LargeFracture {
  Vec3 centre{0.0};      ///< World.
  Vec3 normal{1, 0, 0};  ///< Unit, upwards: it points into the hanging wall.
  double radius = 50.0;  ///< Metres, > 0.
  double width = 0.0;    ///< Of the gap at the centre, metres, ≥ 0; towards the rim it shrinks by 1 − r²/R².
  double step = 0.0;     ///< Metres by which the hanging wall's side of a cliff stands back behind the other; < 0: before it.
  double slip = 0.0;     ///< Metres down the dip by which the hanging wall has moved; < 0: up.

  /// 1 − r²/R² of the point's place in the disc's plane; 0 beyond the rim.
  [[nodiscard]] double share(const Vec3& p) const noexcept;
};

/// A family of large fractures about one mean orientation, in all of space.
struct LargeFractureSet {
  Vec3 normal{1, 0, 0};     ///< Mean, unit.
  double kappa = 100.0;     ///< Fisher concentration about it, > 0.
  double spacing = 60.0;    ///< Mean distance along the mean normal, metres: 1 / P32. > 0.
  double length_lo = 50.0;  ///< Diameters: density ∝ length^−(a+1) between these, metres, 0 < lo ≤ hi.
  double length_hi = 500.0;
  double length_exponent = 1.8;  ///< a, ≥ 0.
  double width = 2.0;            ///< Of the longest; shorter ones are narrower in proportion.
  double step = 0.0, slip = 0.0;  ///< Of the longest, likewise; half of them to either side.
};

/// The fractures of a set that reach into a box, by the numbers of the cells of space that their centres are in: the same
/// ones whatever the box. Poisson points, P30 = P32 / E[π r²].
/// @param origin  Of the cells; they are cubes of the largest length.
/// @throws ParameterError. Cost: O(fractures in the cells within half a largest length of the box).
[[nodiscard]] std::vector<LargeFracture> draw_large_fractures(const LargeFractureSet& set, const Box& box, const Vec3& origin,
                                                              Seed seed, std::uint64_t set_number);

/// How far the surface of rock stands back at p, metres, for the steps of all fractures: ± half of each beside it, fading
/// with the distance to its plane, over its radius.
[[nodiscard]] double setback(std::span<const LargeFracture> fractures, const Vec3& p) noexcept;

struct GapOptions {
  FieldPtr floor;     ///< Gaps are open where it is > 0; where nothing may change, it is no larger than the rock's field.
  double taper = 1.0;  ///< They narrow to nothing where the floor's value falls from this to 0, > 0.
  std::function<bool(const Box&)> untouched;  ///< True: the floor is no larger than the rock anywhere in the box. Null: never.
};

/// Rock with the fractures' gaps cut out: max(rock, min(gap, floor)), gap(p) being the greatest of
/// ½ width · (1 − r²/R²) · taper − |distance to the plane|.
///
/// A gully or notch: widest at the surface, where the floor is far, a wedge towards it. Lipschitz: the greatest of rock's,
/// the floor's, and 1 + ½ width · (2 √2 / radius + L(floor) / taper). Boxes that no gap reaches narrow to rock alone.
/// @throws ParameterError.
[[nodiscard]] FieldPtr with_gaps(FieldPtr rock, std::vector<LargeFracture> fractures, GapOptions options);

}  // namespace outcrop

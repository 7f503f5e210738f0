/// Short whole vectors: the directions in which planes close on the torus side · Z³.
#pragma once

#include <vector>

#include "outcrop/core/vec.h"

namespace outcrop {

[[nodiscard]] int dot(const IVec3& a, const IVec3& b) noexcept;
[[nodiscard]] IVec3 cross(const IVec3& a, const IVec3& b) noexcept;
[[nodiscard]] Vec3 unit(const IVec3& v) noexcept;

/// All whole vectors with |components| ≤ 2, shortest first: enough for |m|² ≤ 9.
[[nodiscard]] const std::vector<IVec3>& small_vectors();

/// Those with |m|² ≤ 9 that have no shorter one along them, one of ± each: a plane at right angles to m closes after it
/// has passed the tile |m| times.
[[nodiscard]] const std::vector<IVec3>& primitive_vectors();

/// The one to which a plane with this normal is best turned: little turn, but short before all.
[[nodiscard]] IVec3 nearest_whole_vector(const Vec3& normal);

/// Radians of turn that one more tile of |m| is worth.
inline constexpr double kLengthPenalty = 8.0 * kPi / 180.0;

}  // namespace outcrop

/// Vectors and matrices of the public API: GLM, double precision, metres.
#pragma once

#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace outcrop {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;  ///< Position or direction; world positions are double, see docs/conventions.md.
using Vec3f = glm::vec3;
using IVec2 = glm::ivec2;
using IVec3 = glm::ivec3;
using Mat3 = glm::dmat3;  ///< Column-major, as GLM: m * v.

inline constexpr double kPi = 3.14159265358979323846;

[[nodiscard]] constexpr double radians(double degrees) noexcept { return degrees * (kPi / 180.0); }
[[nodiscard]] constexpr double degrees(double radians) noexcept { return radians * (180.0 / kPi); }

}  // namespace outcrop

#include "sky.h"

#include <algorithm>
#include <cmath>

namespace outcrop::render {
namespace {

const Vec3f kSun{3.1f, 2.75f, 2.25f};
const Vec3f kZenith{0.34f, 0.52f, 0.86f};
const Vec3f kHorizon{0.86f, 0.93f, 1.02f};
const Vec3f kGroundAlbedo{0.16f, 0.155f, 0.14f};
const Vec3f kHaze{0.40f, 0.46f, 0.54f};
constexpr float kBackdrop = 1.5f;         // Brighter than as a light, so that silhouettes stand out.
constexpr float kRockAlbedo = 0.35f;      // Of an average rock, for light that it passes on.
constexpr float kRockInSun = 0.2f;        // Share of the sun that such rock gets: most of it lies in shade.
constexpr float kRockInSky = 0.3f;        // The same of the sky.
constexpr double kGoldenRatio = 1.618033988749895;
constexpr float kExposure = 0.32f;

/// The fit of the ACES curve by Narkowicz (2015, "ACES filmic tone mapping curve").
float filmic(float x) {
  constexpr float kA = 2.51f, kB = 0.03f, kC = 2.43f, kD = 0.59f, kE = 0.14f;
  return std::clamp(x * (kA * x + kB) / (x * (kC * x + kD) + kE), 0.0f, 1.0f);
}

/// IEC 61966-2-1.
float srgb(float x) { return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f; }

}  // namespace

Vec3f sun_on_white() { return kSun; }

Vec3f sky_radiance(const Vec3& direction, const Vec3& sun) {
  const float up = static_cast<float>(direction.z);
  if (up >= 0.0f) return glm::mix(kHorizon, kZenith, std::sqrt(up));
  const float sun_height = static_cast<float>(std::max(sun.z, 0.0));
  const Vec3f ground = kGroundAlbedo * (sun_height * kSun + 0.5f * (kHorizon + kZenith));
  return glm::mix(kHorizon, ground, std::min(1.0f, std::sqrt(-4.0f * up)));
}

Vec3f backdrop(const Vec3& direction) {
  const float up = static_cast<float>(direction.z);
  if (up >= 0.0f) return kBackdrop * glm::mix(kHorizon, kZenith, std::sqrt(up));
  return kBackdrop * glm::mix(kHorizon, kHaze, std::min(1.0f, std::sqrt(-1.5f * up)));
}

Vec3f rock_radiance(const Vec3& sun) {
  const float sun_height = static_cast<float>(std::max(sun.z, 0.0));
  return kRockAlbedo * (kRockInSun * sun_height * kSun + kRockInSky * 0.5f * (kHorizon + kZenith));
}

Vec3f display_colour(const Vec3f& linear) {
  const Vec3f light = kExposure * linear;
  return {srgb(filmic(light.x)), srgb(filmic(light.y)), srgb(filmic(light.z))};
}

Vec3 cosine_direction(const Vec3& normal, int i, int n, const Vec2& shift) {
  const double u = (i + shift.x) / n;
  const double turn = i * (kGoldenRatio - 1.0) + shift.y;
  const double angle = 2.0 * kPi * (turn - std::floor(turn)), radius = std::sqrt(u);
  // The basis of Duff et al. (2017, listing 3): no branch, no pole.
  const double sign = std::copysign(1.0, normal.z), a = -1.0 / (sign + normal.z), b = normal.x * normal.y * a;
  const Vec3 tangent(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
  const Vec3 bitangent(b, sign + normal.y * normal.y * a, -normal.y);
  return glm::normalize(radius * std::cos(angle) * tangent + radius * std::sin(angle) * bitangent +
                        std::sqrt(std::max(0.0, 1.0 - u)) * normal);
}

}  // namespace outcrop::render

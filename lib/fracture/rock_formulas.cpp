#include "outcrop/fracture/rock_formulas.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace outcrop {
namespace {

double percent(double value) { return std::clamp(value, 0.0, 100.0); }

}  // namespace

double block_volume(const std::array<double, 3>& spacings, const std::array<Vec3, 3>& normals) noexcept {
  const double det = std::abs(glm::dot(normals[0], glm::cross(normals[1], normals[2])));
  if (det < 1e-12) return std::numeric_limits<double>::infinity();
  return spacings[0] * spacings[1] * spacings[2] / det;
}

double block_shape_factor(const std::array<double, 3>& spacings) noexcept {
  const double least = std::min({spacings[0], spacings[1], spacings[2]});
  const double greatest = std::max({spacings[0], spacings[1], spacings[2]});
  const double middle = spacings[0] + spacings[1] + spacings[2] - least - greatest;
  const double a2 = middle / least;
  const double a3 = greatest / least;
  const double sum = a2 + a2 * a3 + a3;
  return sum * sum * sum / (a2 * a3 * a2 * a3);
}

double rqd_2005(double jv) noexcept { return percent(110.0 - 2.5 * jv); }

double rqd_1982(double jv) noexcept { return percent(115.0 - 3.3 * jv); }

double rqd_priest_hudson(double joints_per_metre) noexcept {
  const double t = 0.1 * joints_per_metre;  // pieces of 10 cm and more count
  return 100.0 * std::exp(-t) * (t + 1.0);
}

std::string_view jv_class(double jv) noexcept {
  if (jv < 1.0) return "very large";
  if (jv < 3.0) return "large";
  if (jv < 10.0) return "medium";
  if (jv < 30.0) return "small";
  return "very small";
}

std::string_view volume_class(double volume) noexcept {
  if (volume < 1e-5) return "extremely small";
  if (volume < 2e-4) return "very small";
  if (volume < 1e-2) return "small";
  if (volume < 0.2) return "moderate";
  if (volume < 10.0) return "large";
  return "very large";
}

std::string_view shape_class(double beta) noexcept {
  if (beta < 28.0) return "equidimensional";
  if (beta < 33.0) return "slightly long or flat";
  if (beta < 60.0) return "moderately long or flat";
  if (beta <= 200.0) return "long or flat";
  return "very long or flat";
}

}  // namespace outcrop

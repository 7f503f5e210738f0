/// Fields written as formulas, for tests of the mesher.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/field.h"

namespace outcrop::test {

class FormulaField final : public PointField {
 public:
  FormulaField(std::function<double(const Vec3&)> formula, double lipschitz)
      : formula_(std::move(formula)), lipschitz_(lipschitz) {}
  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override { return formula_(p); }

 private:
  std::function<double(const Vec3&)> formula_;
  double lipschitz_;
};

inline FieldPtr formula(std::function<double(const Vec3&)> f, double lipschitz = 1.0) {
  return std::make_shared<FormulaField>(std::move(f), lipschitz);
}

inline FieldPtr ball(const Vec3& centre, double radius) {
  return formula([=](const Vec3& p) { return glm::length(p - centre) - radius; });
}

inline FieldPtr half_space_below(const Vec3& normal, double distance) {
  return formula([=, n = glm::normalize(normal)](const Vec3& p) { return glm::dot(n, p) - distance; });
}

/// A sum of waves in random directions: rough, with islands, tunnels and voids; mean level `offset`.
inline FieldPtr waves(Seed seed, double wavelength, double offset) {
  constexpr int kWaves = 12;
  std::vector<Vec3> k(kWaves);
  std::vector<double> phase(kWaves);
  for (int i = 0; i < kWaves; ++i) {
    Rng rng(seed, "waves", i);
    k[i] = rng.direction() * (2.0 * kPi / wavelength);
    phase[i] = rng.uniform(0.0, 2.0 * kPi);
  }
  return formula(
      [=](const Vec3& p) {
        double sum = offset;
        for (int i = 0; i < kWaves; ++i) sum += std::sin(glm::dot(k[i], p) + phase[i]) / kWaves;
        return sum;
      },
      2.0 * kPi / wavelength);
}

}  // namespace outcrop::test

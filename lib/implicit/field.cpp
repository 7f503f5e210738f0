#include "outcrop/implicit/field.h"

#include <algorithm>
#include <array>

namespace outcrop {
namespace {

constexpr double kDifferenceStep = 1e-4;  // Metres; central differences of a PointField.

}  // namespace

void Field::between(const Points& points, std::span<const double> floors, std::span<double> values,
                    std::span<Vec3> gradients) const noexcept {
  constexpr std::size_t kChunk = 128;
  std::array<double, kChunk> own;
  std::array<Vec3, kChunk> own_gradients;
  for (std::size_t first = 0; first < points.size(); first += kChunk) {
    const std::size_t n = std::min(kChunk, points.size() - first);
    this->values(points.subspan(first, n), {own.data(), n}, {own_gradients.data(), gradients.empty() ? 0 : n});
    for (std::size_t i = 0; i < n; ++i) {
      if (own[i] >= values[first + i]) continue;
      values[first + i] = own[i];
      if (!gradients.empty()) gradients[first + i] = own_gradients[i];
    }
  }
  for (std::size_t i = 0; i < floors.size(); ++i) values[i] = std::max(floors[i], values[i]);
}

Interval Field::bound(const Box& box) const noexcept {
  const double centre = value(box.centre());
  // |f(p) − f(c)| ≤ L |p − c| ≤ L r for every p in the box; the slack covers rounding in f and r.
  const double reach = lipschitz() * box.half_diagonal() * (1.0 + 1e-12) + 1e-9;
  return {centre - reach, centre + reach};
}

FieldPtr Field::narrow(const Box&) const { return shared_from_this(); }

FieldPtr Field::narrow_to_surface(const Box& box) const {
  return may_change_sign(bound(box)) ? narrow(box) : nullptr;
}

std::optional<Box> Field::support() const noexcept { return std::nullopt; }

void Field::labels(const Points&, std::span<Label> labels) const noexcept {
  for (Label& label : labels) label = 0;
}

double Field::value(const Vec3& p) const noexcept {
  double result = 0.0;
  values({{&p.x, 1}, {&p.y, 1}, {&p.z, 1}}, {&result, 1}, {});
  return result;
}

Vec3 Field::gradient(const Vec3& p) const noexcept {
  double unused = 0.0;
  Vec3 result{0.0};
  values({{&p.x, 1}, {&p.y, 1}, {&p.z, 1}}, {&unused, 1}, {&result, 1});
  return result;
}

void PointField::values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = at(points[i]);
  for (std::size_t i = 0; i < gradients.size(); ++i) gradients[i] = gradient_at(points[i]);
}

Vec3 PointField::gradient_at(const Vec3& p) const noexcept {
  Vec3 result{0.0};
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step{0.0};
    step[axis] = kDifferenceStep;
    result[axis] = (at(p + step) - at(p - step)) / (2.0 * kDifferenceStep);
  }
  return result;
}

}  // namespace outcrop

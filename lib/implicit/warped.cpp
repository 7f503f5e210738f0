#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lanes.h"
#include "outcrop/core/error.h"
#include "outcrop/implicit/combine.h"
#include "unary.h"

namespace outcrop {
namespace {

constexpr double kDifferenceStep = 1e-3;  // Metres, for the gradient of the warped field.
constexpr double kSpreadPerAmplitude = 2.0;

// The Lipschitz constant: b(p) = f(q), q = p + D u, with u the direction of g, g_i = (f(p + h e_i) − f(p − h e_i)) /
// 2h. f is L-Lipschitz, so each g_i changes by at most L/h a metre, and g by η = √3 L / h. As in rounded_polytope.cpp,
// |∇D| ≤ A [F' η + F S + √2 F η / t] and |∇u| ≤ η / t, so b is L (1 + A S + A η K)-Lipschitz with
// K = max over t of F'(t) + (1 + √2) F(t) / t.
constexpr double kLargestGain = 6.1;  // K is 6.036, at t = 0.519.

class WarpedField final : public UnaryField {
 public:
  WarpedField(FieldPtr field, const Warp& warp) : WarpedField(std::move(field), warp, 0.0) {
    lipschitz_ = this->field().lipschitz() *
                 (1.0 + warp.amplitude * (warp.relief->slope() +
                                          std::sqrt(3.0) * this->field().lipschitz() / spread_ * kLargestGain));
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t first = 0; first < points.size(); first += lanes::kLanes) {
      const std::size_t n = std::min<std::size_t>(lanes::kLanes, points.size() - first);
      Block block;
      for (std::size_t i = 0; i < n; ++i)
        for (int axis = 0; axis < 3; ++axis) block.p[axis][i] = points[first + i][axis];
      warped_values(block, n, values.subspan(first, n));
      if (gradients.empty()) continue;
      Values ahead, behind;
      for (int axis = 0; axis < 3; ++axis) {
        warped_values(block.moved(axis, kDifferenceStep), n, {ahead.data(), n});
        warped_values(block.moved(axis, -kDifferenceStep), n, {behind.data(), n});
        for (std::size_t i = 0; i < n; ++i)
          gradients[first + i][axis] = (ahead[i] - behind[i]) / (2.0 * kDifferenceStep);
      }
    }
  }
  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  [[nodiscard]] Modulus modulus() const noexcept override {
    // Both points are displaced by up to the amplitude.
    const Modulus inner = field().modulus();
    return {inner.slope, inner.slack + 2.0 * inner.slope * warp_.amplitude};
  }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    return field().bound(box.grown(warp_.amplitude + kRoundingReach));
  }
  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    return narrowed(box.grown(warp_.amplitude + spread_ + kDifferenceStep + kRoundingReach));
  }

 private:
  static constexpr double kRoundingReach = 1e-6;  // The depth is a float.
  using Values = std::array<double, lanes::kLanes>;

  struct Block {
    Values p[3];

    [[nodiscard]] Points points(std::size_t n) const noexcept {
      return {{p[0].data(), n}, {p[1].data(), n}, {p[2].data(), n}};
    }
    [[nodiscard]] Block moved(int axis, double by) const noexcept {
      Block result = *this;
      for (double& c : result.p[axis]) c += by;
      return result;
    }
  };

  WarpedField(FieldPtr field, const Warp& warp, double lipschitz)
      : UnaryField(std::move(field)),
        warp_(warp),
        spread_(kSpreadPerAmplitude * warp.amplitude),
        lipschitz_(lipschitz) {}

  [[nodiscard]] FieldPtr with(FieldPtr field) const override {
    return std::make_shared<WarpedField>(std::move(field), warp_);
  }

  void warped_values(Block block, std::size_t n, std::span<double> values) const noexcept {
    Values ahead, behind;
    lanes::Lane gradient[3], phase[3];
    for (int axis = 0; axis < 3; ++axis) {
      field().values(block.moved(axis, spread_).points(n), {ahead.data(), n}, {});
      field().values(block.moved(axis, -spread_).points(n), {behind.data(), n}, {});
      for (std::size_t i = 0; i < n; ++i) {
        gradient[axis][i] = static_cast<float>((ahead[i] - behind[i]) / (2.0 * spread_));
        const double repetitions = std::floor(block.p[axis][i] / warp_.relief->period());
        phase[axis][i] = static_cast<float>(block.p[axis][i] - repetitions * warp_.relief->period());
      }
    }
    lanes::Carving carving;
    lanes::carve(warp_, Vec3(0.0), static_cast<int>(n), phase[0], phase[1], phase[2], gradient, carving);
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < n; ++i) block.p[axis][i] += double{carving.step[i]} * gradient[axis][i];
    field().values(block.points(n), values, {});
  }

  Warp warp_;
  double spread_;
  double lipschitz_;
};

}  // namespace

FieldPtr warped(FieldPtr field, const Warp& warp) {
  require(field != nullptr, "field", "a field", "null");
  require(warp.amplitude >= 0.0 && std::isfinite(warp.amplitude), "amplitude", ">= 0 and finite", warp.amplitude);
  if (!warp.active()) return field;
  return std::make_shared<WarpedField>(std::move(field), warp);
}

}  // namespace outcrop

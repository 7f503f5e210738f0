#include "outcrop/tiles/bedded_rock.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

constexpr std::size_t kChunk = 768;  // Points at a time: a mesher's brick of 9³.
constexpr double kWeld =
    1e-3;  // Metres by which both sides of a closed joint overlap, or a film of air would part them.

class BeddedRock final : public Field {
 public:
  BeddedRock(FieldPtr rock, FieldPtr body, BeddingJoint joint)
      : rock_(std::move(rock)), body_(std::move(body)), joint_(std::move(joint)) {
    const double growth = joint_.crack_floor ? joint_.closure_slope * joint_.crack_floor->lipschitz() : 0.0;
    const double cut = body_->lipschitz() + growth;
    const Modulus modulus = rock_->modulus();
    lipschitz_ = std::max(rock_->lipschitz(), cut);
    modulus_ = {std::max(modulus.slope, cut), modulus.slack};
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    std::ranges::fill(values, std::numeric_limits<double>::infinity());
    between(points, {}, values, gradients);
  }

  /// min(v, max(rock, cut)) = max(min(cut, v), min(v, rock)): the cut is one more floor for the rock.
  void between(const Points& points, std::span<const double> floors, std::span<double> values,
               std::span<Vec3> gradients) const noexcept override {
    std::array<double, kChunk> cut, bottom, before;
    std::array<Vec3, kChunk> gradients_before;
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t n = std::min(kChunk, points.size() - first);
      const Points p = points.subspan(first, n);
      const std::span<double> v = values.subspan(first, n);
      const std::span<Vec3> g = gradients.empty() ? gradients : gradients.subspan(first, n);
      cuts(p, {cut.data(), n});
      for (std::size_t i = 0; i < n; ++i) {
        bottom[i] = std::min(cut[i], v[i]);
        if (!floors.empty()) bottom[i] = std::max(bottom[i], floors[first + i]);
        before[i] = v[i];
      }
      std::ranges::copy(g, gradients_before.begin());
      rock_->between(p, {bottom.data(), n}, v, g);
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (v[i] >= before[i])
          g[i] = gradients_before[i];  // Rock may leave anything where the floor holds.
        else if (v[i] == cut[i])
          g[i] = cut_gradient(p[i]);
      }
    }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  [[nodiscard]] Modulus modulus() const noexcept override { return modulus_; }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval cut = cut_bound(box);
    const Interval rock = rock_->bound(box);
    return outcrop::max(rock, cut);
  }

  /// max returns one of its arguments: whichever cannot be the larger in the box is dropped, to the bit.
  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    const Interval cut = cut_bound(box);
    FieldPtr rock = rock_->narrow(box);
    if (cut.hi < rock->bound(box).lo) return rock;
    FieldPtr body = body_->narrow(box);
    BeddingJoint joint = joint_;
    if (joint.crack_floor) joint.crack_floor = joint.crack_floor->narrow(box);
    return std::make_shared<BeddedRock>(std::move(rock), std::move(body), std::move(joint));
  }

  void labels(const Points& points, std::span<Label> labels) const noexcept override { rock_->labels(points, labels); }

 private:
  /// Half of what the joint gapes, given the crack floor's value.
  [[nodiscard]] double half_gap(double floor) const noexcept {
    return std::max(joint_.half_aperture + joint_.closure_slope * std::min(floor, 0.0), -kWeld);
  }

  void cuts(const Points& points, std::span<double> values) const noexcept {
    body_->values(points, values, {});
    std::array<double, kChunk> floor;
    const std::size_t n = points.size();
    if (joint_.crack_floor) joint_.crack_floor->values(points, {floor.data(), n}, {});
    for (std::size_t i = 0; i < n; ++i) values[i] += half_gap(joint_.crack_floor ? floor[i] : 0.0);
  }

  [[nodiscard]] Vec3 cut_gradient(const Vec3& p) const noexcept {
    const Vec3 body = body_->gradient(p);
    if (!joint_.crack_floor) return body;
    const double floor = joint_.crack_floor->value(p);
    const bool closing = floor < 0.0 && joint_.half_aperture + joint_.closure_slope * floor > -kWeld;
    return closing ? body + joint_.closure_slope * joint_.crack_floor->gradient(p) : body;
  }

  [[nodiscard]] Interval cut_bound(const Box& box) const noexcept {
    const Interval body = body_->bound(box);
    const Interval floor = joint_.crack_floor ? joint_.crack_floor->bound(box) : Interval{0.0, 0.0};
    return {body.lo + half_gap(floor.lo), body.hi + half_gap(floor.hi)};
  }

  FieldPtr rock_, body_;
  BeddingJoint joint_;
  double lipschitz_ = 1.0;
  Modulus modulus_{1.0, 0.0};
};

}  // namespace

FieldPtr bedded_rock(FieldPtr rock, FieldPtr body, BeddingJoint joint) {
  require(rock && body, "rock and body", "fields", "null");
  require(joint.closure_slope > 0.0, "closure_slope", "> 0", joint.closure_slope);
  return std::make_shared<BeddedRock>(std::move(rock), std::move(body), std::move(joint));
}

}  // namespace outcrop

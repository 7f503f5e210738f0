#include "outcrop/tiles/finer_joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

constexpr std::size_t kChunk = 768;  // Points at a time: a mesher's brick of 9³.
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class FinerJoints final : public Field {
 public:
  FinerJoints(FieldPtr rock, FieldPtr finer, double depth)
      : rock_(std::move(rock)), finer_(std::move(finer)), depth_(depth) {
    const Modulus a = rock_->modulus(), b = finer_->modulus();
    lipschitz_ = std::max(rock_->lipschitz(), finer_->lipschitz());
    modulus_ = {std::max(a.slope, b.slope), std::max(a.slack, b.slack)};
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    std::ranges::fill(values, kInfinity);
    between(points, {}, values, gradients);
  }

  /// max(floor, min(v, max(c, min(f, c + d)))) = max(max(floor, min(v, c)), min(f, min(v, c + d))): the rock c first,
  /// which is then the floor and the ceiling of the finer rock f.
  void between(const Points& points, std::span<const double> floors, std::span<double> values,
               std::span<Vec3> gradients) const noexcept override {
    std::array<double, kChunk> least, bottom, top, before;
    std::array<Vec3, kChunk> gradients_before, rock_gradients;
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t n = std::min(kChunk, points.size() - first);
      const Points p = points.subspan(first, n);
      const std::span<double> v = values.subspan(first, n);
      const std::span<Vec3> g = gradients.empty() ? gradients : gradients.subspan(first, n);
      std::ranges::copy(v, before.begin());
      std::ranges::copy(g, gradients_before.begin());
      // Rock deeper than floor − d does not matter. A bit below: else rounding might bring c + d above the floor.
      for (std::size_t i = 0; i < floors.size() && i < n; ++i)
        least[i] = std::nextafter(floors[first + i] - depth_, -kInfinity);
      rock_->between(p, floors.empty() ? floors : std::span<const double>(least).first(n), v, g);
      std::ranges::copy(g, rock_gradients.begin());
      for (std::size_t i = 0; i < n; ++i) {
        bottom[i] = floors.empty() ? v[i] : std::max(v[i], floors[first + i]);
        v[i] = top[i] = std::min(before[i], v[i] + depth_);
      }
      finer_->between(p, {bottom.data(), n}, v, g);
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (v[i] >= before[i])
          g[i] = gradients_before[i];
        else if (v[i] == bottom[i] || v[i] == top[i])
          g[i] = rock_gradients[i];
      }
    }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  [[nodiscard]] Modulus modulus() const noexcept override { return modulus_; }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval rock = rock_->bound(box);
    const Interval deepest{rock.lo, rock.hi + depth_};
    if (!may_change_sign(deepest)) return deepest;  // All air or all rock: the joints cannot change that.
    const Interval finer = finer_->bound(box);
    return {std::max(rock.lo, std::min(finer.lo, rock.lo + depth_)),
            std::max(rock.hi, std::min(finer.hi, rock.hi + depth_))};
  }

  /// Where the finer rock is nowhere above the rock there are no joints.
  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    FieldPtr rock = rock_->narrow(box);
    if (finer_->bound(box).hi < rock->bound(box).lo) return rock;
    return std::make_shared<FinerJoints>(std::move(rock), finer_->narrow(box), depth_);
  }

  void labels(const Points& points, std::span<Label> labels) const noexcept override { rock_->labels(points, labels); }

 private:
  FieldPtr rock_, finer_;
  double depth_;
  double lipschitz_ = 1.0;
  Modulus modulus_{1.0, 0.0};
};

}  // namespace

FieldPtr with_finer_joints(FieldPtr rock, FieldPtr finer, double depth) {
  require(rock && finer, "rock and finer", "fields", "null");
  require(depth > 0.0 && std::isfinite(depth), "depth", "> 0 m", depth);
  return std::make_shared<FinerJoints>(std::move(rock), std::move(finer), depth);
}

}  // namespace outcrop

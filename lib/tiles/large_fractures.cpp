#include "outcrop/tiles/large_fractures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "outcrop/core/error.h"
#include "outcrop/fracture/joints.h"

namespace outcrop {
namespace {

constexpr std::size_t kChunk = 768;  // Points at a time: a mesher's brick of 9³.

/// What a point is to a fracture.
struct Place {
  double height;  ///< Over its plane.
  Vec3 aside;     ///< From its centre, in its plane.
};

Place place(const LargeFracture& fracture, const Vec3& p) {
  const Vec3 d = p - fracture.centre;
  const double height = glm::dot(fracture.normal, d);
  return {height, d - height * fracture.normal};
}

// 1 − r²/R², but no less than −1: below 0 beyond the rim, or a film of air would be left in the disc's plane.
double share_of(const LargeFracture& fracture, const Vec3& aside) {
  return std::max(-1.0, 1.0 - glm::dot(aside, aside) / (fracture.radius * fracture.radius));
}

class Gaps final : public Field {
 public:
  Gaps(FieldPtr rock, FieldPtr floor, std::vector<LargeFracture> fractures, double taper,
       std::function<bool(const Box&)> untouched)
      : rock_(std::move(rock)),
        floor_(std::move(floor)),
        fractures_(std::move(fractures)),
        taper_(taper),
        untouched_(std::move(untouched)) {
    double slope = floor_->lipschitz();
    for (const LargeFracture& f : fractures_)
      slope = std::max(slope, 1.0 + std::sqrt(2.0) * f.width / f.radius + 0.5 * f.width * floor_->lipschitz() / taper_);
    const Modulus modulus = rock_->modulus();
    lipschitz_ = std::max(rock_->lipschitz(), slope);
    modulus_ = {std::max(modulus.slope, slope), modulus.slack};
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    rock_->values(points, values, gradients);
    for (std::size_t first = 0; first < points.size(); first += kChunk) {
      const std::size_t n = std::min(kChunk, points.size() - first);
      chunk(points.subspan(first, n), values.subspan(first, n), gradients.empty() ? gradients : gradients.subspan(first, n));
    }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  /// max and min change by no more than the largest change of an argument.
  [[nodiscard]] Modulus modulus() const noexcept override { return modulus_; }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval rock = rock_->bound(box);
    if (untouched_ && untouched_(box)) return rock;
    const Interval floor = floor_->bound(box);
    if (floor.hi <= rock.lo) return rock;
    Interval gap{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const LargeFracture& fracture : fractures_) gap = outcrop::max(gap, gap_bound(fracture, box, floor));
    return outcrop::max(rock, outcrop::min(gap, floor));
  }

  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    FieldPtr rock = rock_->narrow(box);
    if (untouched_ && untouched_(box)) return rock;
    const Interval floor = floor_->bound(box);
    const double lowest = rock->bound(box).lo;
    if (floor.hi <= lowest) return rock;
    // max returns one of its arguments: what is no larger than rock anywhere is dropped to the bit.
    std::vector<LargeFracture> kept;
    for (const LargeFracture& fracture : fractures_)
      if (gap_bound(fracture, box, floor).hi > lowest) kept.push_back(fracture);
    if (kept.empty()) return rock;
    return std::make_shared<Gaps>(std::move(rock), floor_->narrow(box), std::move(kept), taper_, untouched_);
  }

  [[nodiscard]] std::optional<Box> support() const noexcept override { return rock_->support(); }
  void labels(const Points& points, std::span<Label> labels) const noexcept override { rock_->labels(points, labels); }

 private:
  [[nodiscard]] Interval gap_bound(const LargeFracture& fracture, const Box& box, const Interval& floor) const noexcept {
    const Vec3 centre = box.centre();
    const Vec3 half = 0.5 * box.size();
    const double height = glm::dot(fracture.normal, centre - fracture.centre);
    const double reach = glm::dot(glm::abs(fracture.normal), half) + 1e-9 * (1.0 + std::abs(height));
    const double nearest = std::max(0.0, std::abs(height) - reach);
    // In its plane a box reaches no farther than half its diagonal.
    const double aside = std::max(0.0, glm::length(place(fracture, centre).aside) - glm::length(half) * (1.0 + 1e-9));
    const double share = std::max(0.0, 1.0 - aside * aside / (fracture.radius * fracture.radius));
    const double open = std::clamp(floor.hi / taper_, 0.0, 1.0);
    return {-(std::abs(height) + reach + 0.5 * fracture.width), 0.5 * fracture.width * share * open * (1.0 + 1e-12) - nearest};
  }

  void chunk(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
    // The floor is asked only where the widest gap would matter.
    std::array<std::uint16_t, kChunk> where;
    std::array<double, kChunk> x, y, z, floor;
    std::array<Vec3, kChunk> floor_gradients;
    std::size_t n = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points[i];
      const bool matters = std::ranges::any_of(fractures_, [&](const LargeFracture& f) {
        return 0.5 * f.width - std::abs(glm::dot(f.normal, p - f.centre)) > values[i];
      });
      if (!matters) continue;
      where[n] = static_cast<std::uint16_t>(i);
      x[n] = p.x, y[n] = p.y, z[n] = p.z;
      ++n;
    }
    if (n == 0) return;
    const Points asked{{x.data(), n}, {y.data(), n}, {z.data(), n}};
    floor_->values(asked, {floor.data(), n}, {floor_gradients.data(), gradients.empty() ? 0 : n});
    for (std::size_t k = 0; k < n; ++k) {
      double& value = values[where[k]];
      if (floor[k] <= value) continue;
      const double open = std::clamp(floor[k] / taper_, 0.0, 1.0);
      const LargeFracture* widest = nullptr;
      Place at{};
      double gap = -std::numeric_limits<double>::infinity();
      for (const LargeFracture& fracture : fractures_) {
        const Place here = place(fracture, asked[k]);
        const double width = 0.5 * fracture.width * share_of(fracture, here.aside) * open - std::abs(here.height);
        if (width <= gap) continue;
        gap = width;
        widest = &fracture;
        at = here;
      }
      const double cut = std::min(gap, floor[k]);
      if (cut <= value) continue;
      value = cut;
      if (gradients.empty()) continue;
      Vec3& gradient = gradients[where[k]];
      gradient = floor_gradients[k];
      if (floor[k] <= gap) continue;
      const double share = share_of(*widest, at.aside);
      const double half = 0.5 * widest->width;
      gradient = (at.height < 0.0 ? 1.0 : -1.0) * widest->normal;
      if (share > -1.0) gradient -= half * open * 2.0 / (widest->radius * widest->radius) * at.aside;
      if (floor[k] > 0.0 && floor[k] < taper_) gradient += half * share / taper_ * floor_gradients[k];
    }
  }

  FieldPtr rock_, floor_;
  std::vector<LargeFracture> fractures_;
  double taper_;
  std::function<bool(const Box&)> untouched_;
  double lipschitz_ = 1.0;
  Modulus modulus_{1.0, 0.0};
};

void check(const LargeFractureSet& set) {
  require(std::abs(glm::length(set.normal) - 1.0) < 1e-6, "normal", "a unit vector", glm::length(set.normal));
  require(std::isfinite(set.kappa) && set.kappa > 0.0, "kappa", "> 0 and finite", set.kappa);
  require(std::isfinite(set.spacing) && set.spacing > 0.0, "spacing", "> 0 and finite", set.spacing);
  require(set.length_lo > 0.0, "length", "> 0", set.length_lo);
  require(set.length_hi >= set.length_lo && std::isfinite(set.length_hi), "length", "the smallest before the largest", set.length_hi);
  require(set.length_exponent >= 0.0 && set.length_exponent <= 20.0, "length_exponent", "in [0, 20]", set.length_exponent);
  require(set.width >= 0.0 && std::isfinite(set.width), "width", "≥ 0 and finite", set.width);
}

// The x at which a share u of a density ∝ x^−(a+1) on [lo, hi] lies below.
double power_law(double lo, double hi, double a, double u) {
  if (lo == hi) return lo;
  if (a == 0.0) return lo * std::pow(hi / lo, u);
  return lo * std::pow(1.0 - u * (1.0 - std::pow(lo / hi, a)), -1.0 / a);
}

// The mean of x² for it.
double mean_square(double lo, double hi, double a) {
  if (lo == hi) return lo * lo;
  const auto moment = [&](double k) {  // ∫ x^(k − a − 1)
    return std::abs(k - a) < 1e-9 ? std::log(hi / lo) : (std::pow(hi, k - a) - std::pow(lo, k - a)) / (k - a);
  };
  return moment(2.0) / moment(0.0);
}

}  // namespace

double LargeFracture::share(const Vec3& p) const noexcept { return std::max(0.0, share_of(*this, place(*this, p).aside)); }

std::vector<LargeFracture> draw_large_fractures(const LargeFractureSet& set, const Box& box, const Vec3& origin, Seed seed,
                                                std::uint64_t set_number) {
  check(set);
  const double cell = set.length_hi;
  const double largest = 0.5 * set.length_hi;
  const double area = kPi * 0.25 * mean_square(set.length_lo, set.length_hi, set.length_exponent);
  const double expected = cell * cell * cell / (set.spacing * area);  // fractures a cell
  require(expected < 1e6, "spacing", "at most a million fractures a cube of the largest length", expected);
  const Vec3 lo = glm::floor((box.lo - largest - origin) / cell);
  const Vec3 hi = glm::floor((box.hi + largest - origin) / cell);
  std::vector<LargeFracture> fractures;
  for (double z = lo.z; z <= hi.z; ++z)
    for (double y = lo.y; y <= hi.y; ++y)
      for (double x = lo.x; x <= hi.x; ++x) {
        // One stream a cell, whatever else is drawn: 21 bits of each number are enough for any planet.
        constexpr std::int64_t kBits = (1 << 21) - 1;
        const auto part = [&](double v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v) & kBits); };
        Rng rng(seed + set_number, "large fractures", (part(z) << 42) | (part(y) << 21) | part(x));
        // Poisson: arrivals at a rate of 1 until the expected time is over.
        for (double time = -std::log1p(-rng.uniform()); time < expected; time += -std::log1p(-rng.uniform())) {
          LargeFracture f;
          for (int axis = 0; axis < 3; ++axis) f.centre[axis] = cell * rng.uniform();
          f.centre += origin + cell * Vec3(x, y, z);
          f.radius = 0.5 * power_law(set.length_lo, set.length_hi, set.length_exponent, rng.uniform());
          const double size = 2.0 * f.radius / set.length_hi;
          f.normal = fisher_direction(set.normal, set.kappa, rng);
          const double way = rng.uniform() < 0.5 ? -1.0 : 1.0;
          f.width = set.width * size;
          f.step = way * set.step * size;
          f.slip = way * set.slip * size;
          // The box against the disc's slab and ball.
          const Vec3 nearest = glm::clamp(f.centre, box.lo, box.hi) - f.centre;
          const double reach = 0.5 * glm::dot(glm::abs(f.normal), box.size()) + 0.5 * f.width;
          if (glm::length(nearest) > f.radius || std::abs(glm::dot(f.normal, box.centre() - f.centre)) > reach) continue;
          fractures.push_back(f);
        }
      }
  return fractures;
}

double setback(std::span<const LargeFracture> fractures, const Vec3& p) noexcept {
  double sum = 0.0;
  for (const LargeFracture& f : fractures) {
    if (f.step == 0.0) continue;
    const Vec3 d = p - f.centre;
    if (glm::dot(d, d) >= 2.0 * f.radius * f.radius) continue;
    const Place at = place(f, p);
    const double near = 1.0 - std::abs(at.height) / f.radius;
    if (near > 0.0) sum += (at.height < 0.0 ? -0.5 : 0.5) * f.step * std::max(0.0, share_of(f, at.aside)) * near;
  }
  return sum;
}

FieldPtr with_gaps(FieldPtr rock, std::vector<LargeFracture> fractures, GapOptions options) {
  require(options.taper > 0.0 && std::isfinite(options.taper), "taper", "> 0 and finite", options.taper);
  require(options.floor != nullptr, "floor", "a field", "none");
  std::erase_if(fractures, [](const LargeFracture& f) { return f.width <= 0.0; });
  for (const LargeFracture& f : fractures) {
    require(std::abs(glm::length(f.normal) - 1.0) < 1e-6, "normal", "a unit vector", glm::length(f.normal));
    require(f.radius > 0.0 && std::isfinite(f.radius), "radius", "> 0 and finite", f.radius);
    require(std::isfinite(f.width), "width", "finite", f.width);
  }
  if (fractures.empty()) return rock;
  return std::make_shared<Gaps>(std::move(rock), std::move(options.floor), std::move(fractures), options.taper,
                                std::move(options.untouched));
}

}  // namespace outcrop

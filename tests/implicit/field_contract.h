/// The contract that every Field passes: finite, 1-to-L Lipschitz, `bound` contains, `narrow` equals, a batch equals
/// singles.
///
/// Call `check_field_contract(*field, region)` in a test of the node. `region` is where the field is used: a box that
/// holds the interesting part of its surface. The field must be owned by a FieldPtr (std::make_shared), as everywhere.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/field.h"

namespace outcrop::test {

/// Calls `f(seed)` for seeds 1 … count; a failure names its seed.
template <class F>
void for_each_seed(int count, F&& f) {
  for (Seed seed = 1; seed <= static_cast<Seed>(count); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    f(seed);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// Positions as the structure of arrays that Field::values takes.
struct PointList {
  std::vector<double> x, y, z;

  void push_back(const Vec3& p) {
    x.push_back(p.x);
    y.push_back(p.y);
    z.push_back(p.z);
  }
  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] Points view() const { return {x, y, z}; }
  [[nodiscard]] Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// Everything a field says about some points, from one batch.
struct FieldAnswers {
  std::vector<double> values;
  std::vector<Vec3> gradients;
  std::vector<Label> labels;

  FieldAnswers(const Field& field, const Points& points)
      : values(points.size()), gradients(points.size()), labels(points.size()) {
    field.values(points, values, gradients);
    field.labels(points, labels);
  }
};

[[nodiscard]] inline Vec3 random_point(Rng& rng, const Box& box) {
  Vec3 p{0.0};
  for (int axis = 0; axis < 3; ++axis) p[axis] = std::min(rng.uniform(box.lo[axis], box.hi[axis]), box.hi[axis]);
  return p;
}

/// A box inside `region` whose edges are between 10⁻³ and 1 of the region's, all alike (cubes) or not.
[[nodiscard]] inline Box random_box(Rng& rng, const Box& region) {
  const Vec3 size = region.size();
  const double share = std::pow(10.0, rng.uniform(-3.0, 0.0));
  const bool cube = rng.uniform() < 0.5;
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const double own = cube ? share : std::pow(10.0, rng.uniform(-3.0, 0.0));
    const double lo = rng.uniform(region.lo[axis], region.hi[axis] - own * size[axis]);
    box.lo[axis] = std::max(lo, region.lo[axis]);
    box.hi[axis] = std::min(lo + own * size[axis], region.hi[axis]);
  }
  return box;
}

/// `count` random points of the box, its corners and its centre.
[[nodiscard]] inline PointList points_in(Rng& rng, const Box& box, int count) {
  PointList points;
  for (int i = 0; i < count; ++i) points.push_back(random_point(rng, box));
  for (int corner = 0; corner < 8; ++corner)
    points.push_back(
        {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y, corner & 4 ? box.hi.z : box.lo.z});
  points.push_back(box.centre());
  return points;
}

/// What rounding may add to a difference of two values in the region: fields may compute in floats relative to its
/// scale.
[[nodiscard]] inline double rounding_slack(const Box& region) { return 1e-6 * (1.0 + glm::length(region.size())); }

[[nodiscard]] inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Values, gradients, labels and bounds are finite and bounds hold: in the region, far from it, and at coordinates up
/// to 1e7.
inline void check_finite(const Field& field, const Box& region, Rng& rng) {
  const double size = glm::length(region.size());
  for (const double reach : {0.0, size, 100.0 * size, 1e4, 1e7}) {
    Box box = region.grown(reach);
    if (reach == 1e7) box = {Vec3(-1e7), Vec3(1e7)};
    const PointList points = points_in(rng, box, 60);
    const FieldAnswers answers(field, points.view());
    const Interval bound = field.bound(box);
    ASSERT_TRUE(std::isfinite(bound.lo) && std::isfinite(bound.hi)) << "bound of a box grown by " << reach << " m";
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points[i];
      ASSERT_TRUE(std::isfinite(answers.values[i])) << "value at " << p.x << ' ' << p.y << ' ' << p.z;
      ASSERT_TRUE(is_finite(answers.gradients[i])) << "gradient at " << p.x << ' ' << p.y << ' ' << p.z;
      ASSERT_TRUE(bound.contains(answers.values[i]))
          << "bound [" << bound.lo << ", " << bound.hi << "] of a box grown by " << reach << " m misses "
          << answers.values[i];
    }
  }
}

/// |f(p) − f(q)| ≤ L |p − q|, and what the modulus says, for near and far pairs in the box.
inline void check_lipschitz(const Field& field, const Box& box, double slack, Rng& rng, int pairs) {
  const double lipschitz = field.lipschitz();
  ASSERT_TRUE(std::isfinite(lipschitz) && lipschitz >= 0.0) << "lipschitz() is " << lipschitz;
  const Modulus modulus = field.modulus();
  ASSERT_TRUE(std::isfinite(modulus.slope) && modulus.slope >= 0.0 && std::isfinite(modulus.slack) &&
              modulus.slack >= 0.0)
      << "modulus() is " << modulus.slope << ", " << modulus.slack;
  PointList from, to;
  for (int i = 0; i < pairs; ++i) {
    const Vec3 p = random_point(rng, box);
    const double step = glm::length(box.size()) * std::pow(10.0, rng.uniform(-5.0, 0.0));
    const Vec3 direction = rng.direction();
    from.push_back(p);
    to.push_back(glm::clamp(p + step * direction, box.lo, box.hi));
  }
  const FieldAnswers a(field, from.view());
  const FieldAnswers b(field, to.view());
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double distance = glm::length(from[i] - to[i]);
    ASSERT_LE(std::abs(a.values[i] - b.values[i]), lipschitz * distance + slack)
        << "L = " << lipschitz << ", |p - q| = " << distance << ", p = " << from[i].x << ' ' << from[i].y << ' '
        << from[i].z;
    ASSERT_LE(std::abs(a.values[i] - b.values[i]), modulus.slope * distance + modulus.slack + slack)
        << "modulus " << modulus.slope << ", " << modulus.slack << ", |p - q| = " << distance;
  }
}

/// bound(box) contains the values at random points and corners of the box.
inline void check_bound(const Field& field, const Box& box, Rng& rng) {
  const Interval bound = field.bound(box);
  const PointList points = points_in(rng, box, 40);
  const FieldAnswers answers(field, points.view());
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_TRUE(bound.contains(answers.values[i]))
        << "[" << bound.lo << ", " << bound.hi << "] misses " << answers.values[i] << " at " << points[i].x << ' '
        << points[i].y << ' ' << points[i].z << " in a box of size " << box.size().x << ' ' << box.size().y << ' '
        << box.size().z;
}

/// Two fields agree to the bit on points of the box: values, gradients, labels.
inline void check_equal_in(const Field& expected, const Field& got, const Box& box, Rng& rng) {
  const PointList points = points_in(rng, box, 60);
  const FieldAnswers a(expected, points.view());
  const FieldAnswers b(got, points.view());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(a.values[i], b.values[i]) << "narrowed value at point " << i;
    ASSERT_EQ(a.labels[i], b.labels[i]) << "narrowed label at point " << i;
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(a.gradients[i][axis], b.gradients[i][axis]) << "narrowed gradient at point " << i << ", axis " << axis;
  }
}

/// `between` is the value between floor and ceiling, to the bit, and its gradient where it is below the ceiling.
inline void check_between(const Field& field, const Box& box, Rng& rng) {
  const PointList points = points_in(rng, box, 150);
  const std::size_t n = points.size();
  const FieldAnswers answers(field, points.view());
  const double spread = std::max(glm::length(box.size()), 1e-3);
  std::vector<double> floors, ceilings;
  for (std::size_t i = 0; i < n; ++i) {
    // Ends far from the value and close to it, on either side.
    const double reach = spread * std::pow(10.0, rng.uniform(-5.0, 0.0));
    const double middle = answers.values[i] + reach * rng.uniform(-1.0, 1.0);
    floors.push_back(middle - reach * rng.uniform());
    ceilings.push_back(middle + reach * rng.uniform());
  }
  const Vec3 untouched(7.0, 8.0, 9.0);
  std::vector<double> got = ceilings, alone = ceilings, unbounded = ceilings;
  std::vector<Vec3> gradients(n, untouched);
  field.between(points.view(), floors, got, gradients);
  field.between(points.view(), floors, alone, {});
  field.between(points.view(), {}, unbounded, {});
  for (std::size_t i = 0; i < n; ++i) {
    const double v = answers.values[i];
    ASSERT_EQ(got[i], std::max(floors[i], std::min(ceilings[i], v))) << "between floor and ceiling, point " << i;
    ASSERT_EQ(alone[i], got[i]) << "with and without gradients, point " << i;
    ASSERT_EQ(unbounded[i], std::min(ceilings[i], v)) << "below the ceiling, point " << i;
    double single = ceilings[i];
    Vec3 single_gradient = untouched;
    field.between(points.view().subspan(i, 1), {&floors[i], 1}, {&single, 1}, {&single_gradient, 1});
    ASSERT_EQ(single, got[i]) << "alone and in a batch, point " << i;
    if (v > floors[i]) {
      ASSERT_EQ(single_gradient, gradients[i]) << "gradient alone and in a batch, point " << i;
    }
    if (v <= floors[i]) continue;
    const Vec3 expected = v < ceilings[i] ? answers.gradients[i] : untouched;
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(gradients[i][axis], expected[axis]) << "gradient between floor and ceiling, point " << i;
  }
}

/// narrow(box) equals in the box, keeps the contract there, and so does what it is narrowed to in turn.
inline void check_narrow(const Field& field, const Box& box, double slack, Rng& rng) {
  FieldPtr narrowed = field.narrow(box);
  Box inner = box;
  for (int depth = 0; depth < 3; ++depth) {
    SCOPED_TRACE("narrowed " + std::to_string(depth + 1) + " times");
    ASSERT_TRUE(narrowed);
    check_equal_in(field, *narrowed, inner, rng);
    check_bound(*narrowed, inner, rng);
    check_between(*narrowed, inner, rng);
    check_lipschitz(*narrowed, inner, slack, rng, 40);
    if (::testing::Test::HasFatalFailure()) return;
    inner = random_box(rng, inner);
    narrowed = narrowed->narrow(inner);
  }
}

/// A batch of n equals n batches of one; values do not depend on whether gradients are asked for.
inline void check_batches(const Field& field, const Box& region, Rng& rng) {
  for (const std::size_t n : {std::size_t{1}, std::size_t{7}, std::size_t{64}, std::size_t{65}, std::size_t{500}}) {
    SCOPED_TRACE("batch of " + std::to_string(n));
    PointList points;
    for (std::size_t i = 0; i < n; ++i) points.push_back(random_point(rng, region));
    const FieldAnswers batch(field, points.view());
    std::vector<double> values_alone(n);
    field.values(points.view(), values_alone, {});
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(batch.values[i], values_alone[i]) << "value with and without gradients, point " << i;
      ASSERT_EQ(batch.values[i], field.value(points[i])) << "value alone and in a batch, point " << i;
      const Vec3 gradient = field.gradient(points[i]);
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_EQ(batch.gradients[i][axis], gradient[axis]) << "gradient alone and in a batch, point " << i;
      Label label = 0;
      field.labels(points.view().subspan(i, 1), {&label, 1});
      ASSERT_EQ(batch.labels[i], label) << "label alone and in a batch, point " << i;
    }
  }
}

/// At 3 of 4 random points the gradient is what central differences see, and no gradient is longer than L.
inline void check_gradients(const Field& field, const Box& region, Rng& rng) {
  const int count = 200;
  const double step = std::min(1e-3, 1e-4 * glm::length(region.size()));
  const double tolerance = 0.02 * std::max(field.lipschitz(), 1e-6) + rounding_slack(region) / step;
  int agreeing = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3 p = random_point(rng, region);
    const Vec3 gradient = field.gradient(p);
    ASSERT_LE(glm::length(gradient), field.lipschitz() * 1.001 + rounding_slack(region) / step);
    Vec3 difference{0.0};
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 ahead = p, behind = p;
      ahead[axis] += step;
      behind[axis] -= step;
      difference[axis] = (field.value(ahead) - field.value(behind)) / (ahead[axis] - behind[axis]);
    }
    if (glm::length(difference - gradient) <= tolerance) ++agreeing;
  }
  ASSERT_GE(agreeing, count * 3 / 4) << "of " << count << " gradients agree with central differences";
}

/// Attacks `field` from all sides of the contract in outcrop/implicit/field.h.
///
/// @param region  Where the field is used; not empty, all edges > 0.
/// @param seeds   Random starts; 8 take some 20 000 evaluations.
inline void check_field_contract(const Field& field, const Box& region, int seeds = 8) {
  const double slack = rounding_slack(region);
  for_each_seed(seeds, [&](Seed seed) {
    Rng rng(seed, "field contract");
    check_finite(field, region, rng);
    check_lipschitz(field, region, slack, rng, 200);
    check_between(field, region, rng);
    check_bound(field, region, rng);
    check_narrow(field, region, slack, rng);
    for (int i = 0; i < 12 && !::testing::Test::HasFatalFailure(); ++i) {
      const Box box = random_box(rng, region);
      check_bound(field, box, rng);
      check_narrow(field, box, slack, rng);
    }
    check_bound(field, {region.centre(), region.centre()}, rng);
    check_batches(field, region, rng);
    check_gradients(field, region, rng);
  });
}

}  // namespace outcrop::test

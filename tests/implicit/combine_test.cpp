#include "outcrop/implicit/combine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/field_contract.h"
#include "implicit/shapes.h"
#include "outcrop/core/error.h"
#include "outcrop/implicit/primitives.h"

namespace outcrop {
namespace {

const Box kRegion{Vec3(-3.0), Vec3(3.0)};

[[nodiscard]] std::vector<FieldPtr> some_fields() {
  return {labelled(sphere({-1, 0, 0}, 1.2), 3), labelled(box_solid({{-0.5, -1, -1}, {2, 1, 0.5}}, 0.1), 7),
          labelled(capsule({-1, -1, 1}, {1, 1, 1}, 0.6), 9), labelled(half_space({{0, 0, 1}, 1.5}), 11)};
}

[[nodiscard]] Mat3 some_rotation(Seed seed) {
  Rng rng(seed, "rotation");
  const Vec3 x = rng.direction();
  const Vec3 z = glm::normalize(glm::cross(x, rng.direction()));
  return {x, glm::cross(z, x), z};
}

TEST(Combinations, PassTheContractSharpAndSmooth) {
  for (const double radius : {0.0, 0.3, 2.0}) {
    SCOPED_TRACE(radius);
    test::check_field_contract(*smooth_union_of(some_fields(), radius), kRegion, 3);
    test::check_field_contract(*smooth_intersection_of(some_fields(), radius), kRegion, 3);
    test::check_field_contract(*smooth_difference_of(some_fields()[1], some_fields()[0], radius), kRegion, 3);
  }
}

TEST(Combinations, OfCombinationsPassTheContract) {
  const FieldPtr all = union_of({difference_of(some_fields()[1], some_fields()[2]),
                                 intersection_of({some_fields()[0], some_fields()[3]}),
                                 smooth_union_of({some_fields()[2], some_fields()[0]}, 0.4)});
  test::check_field_contract(*all, kRegion, 3);
}

TEST(Combinations, AreMinimaAndMaximaOfTheirFields) {
  const std::vector<FieldPtr> fields = some_fields();
  test::for_each_seed(100, [&](Seed seed) {
    Rng rng(seed, "points");
    const Vec3 p = test::random_point(rng, kRegion);
    double least = 1e9, most = -1e9;
    for (const FieldPtr& field : fields) {
      least = std::min(least, field->value(p));
      most = std::max(most, field->value(p));
    }
    EXPECT_EQ(union_of(fields)->value(p), least);
    EXPECT_EQ(intersection_of(fields)->value(p), most);
    EXPECT_EQ(difference_of(fields[0], fields[1])->value(p), std::max(fields[0]->value(p), -fields[1]->value(p)));
    EXPECT_LE(smooth_union_of(fields, 0.5)->value(p), least);
    EXPECT_GE(smooth_union_of(fields, 0.5)->value(p), least - 0.5);
    EXPECT_GE(smooth_intersection_of(fields, 0.5)->value(p), most);
    EXPECT_LE(smooth_intersection_of(fields, 0.5)->value(p), most + 0.5);
  });
}

TEST(SmoothUnion, BulgesByASixthOfTheRadiusWhereTwoFieldsAreEqual) {
  const FieldPtr blend = smooth_union_of({sphere({-1, 0, 0}, 1), sphere({1, 0, 0}, 1)}, 0.6);
  EXPECT_DOUBLE_EQ(blend->value({0, 0, 0}), -0.1);
}

TEST(Union, LabelsByTheFieldThatIsSmallest) {
  const std::vector<FieldPtr> fields = some_fields();
  const FieldPtr all = union_of(fields);
  test::for_each_seed(200, [&](Seed seed) {
    Rng rng(seed, "points");
    test::PointList p;
    p.push_back(test::random_point(rng, kRegion));
    const test::FieldAnswers together(*all, p.view());
    for (const FieldPtr& field : fields) {
      const test::FieldAnswers alone(*field, p.view());
      if (alone.values[0] == together.values[0]) {
        ASSERT_EQ(alone.labels[0], together.labels[0]);
      }
    }
  });
}

TEST(Difference, KeepsTheMaterialOfWhatIsCarved) {
  const FieldPtr carved = difference_of(labelled(box_solid(kRegion), 5), labelled(sphere({0, 0, 0}, 1), 6));
  test::PointList wall;
  wall.push_back({1.0, 0, 0});
  EXPECT_EQ(test::FieldAnswers(*carved, wall.view()).labels[0], 5);
  const FieldPtr narrowed = carved->narrow({{0.9, -0.1, -0.1}, {1.1, 0.1, 0.1}});
  EXPECT_EQ(test::FieldAnswers(*narrowed, wall.view()).labels[0], 5);
}

/// Counts what it is asked, to see who is still there after narrowing.
class Counted final : public PointField {
 public:
  Counted(Vec3 centre, std::shared_ptr<int> calls) : centre_(centre), calls_(std::move(calls)) {}
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override {
    ++*calls_;
    return glm::length(p - centre_) - 1.0;
  }

 private:
  Vec3 centre_;
  std::shared_ptr<int> calls_;
};

TEST(Union, NarrowedToOneFieldAsksNoOther) {
  for (const double radius : {0.0, 0.5}) {
    std::vector<FieldPtr> fields;
    const auto calls = std::make_shared<int>(0);
    for (int i = 0; i < 10; ++i) fields.push_back(std::make_shared<Counted>(Vec3(4.0 * i, 0, 0), calls));
    const FieldPtr narrowed = smooth_union_of(fields, radius)->narrow({{11.8, -0.2, -0.2}, {12.2, 0.2, 0.2}});
    *calls = 0;
    (void)narrowed->value({12, 0, 0});
    EXPECT_EQ(*calls, 1) << "radius " << radius;
  }
}

TEST(Transformed, PassesTheContractAndMovesItsLabels) {
  for (Seed seed = 1; seed <= 3; ++seed)
    test::check_field_contract(*transformed(union_of(some_fields()), some_rotation(seed), 0.7, {0.2, -0.3, 0.1}),
                               kRegion, 2);
  const Vec3 far{4.1e5, 5.2e6, 1000.0};
  test::check_field_contract(*transformed(union_of(some_fields()), some_rotation(4), 1.0, far), kRegion.moved(far), 2);
}

TEST(Transformed, IsTheFieldAtTheLocalPointTimesTheScale) {
  const FieldPtr field = union_of(some_fields());
  test::for_each_seed(50, [&](Seed seed) {
    Rng rng(seed, "points");
    const Mat3 rotation = some_rotation(seed);
    const Vec3 local = test::random_point(rng, kRegion);
    const FieldPtr moved = transformed(field, rotation, 2.5, {10, 20, 30});
    ASSERT_NEAR(moved->value(2.5 * (rotation * local) + Vec3(10, 20, 30)), 2.5 * field->value(local), 1e-9);
  });
  EXPECT_THROW((void)transformed(field, Mat3(2.0), 1.0, Vec3(0.0)), ParameterError);
  EXPECT_THROW((void)transformed(field, Mat3(1.0), 0.0, Vec3(0.0)), ParameterError);
}

TEST(OffsetAndShell, PassTheContractAndShiftTheSurface) {
  const FieldPtr ball = sphere({0, 0, 0}, 1.5);
  test::check_field_contract(*offset(union_of(some_fields()), 0.3), kRegion, 3);
  test::check_field_contract(*shell(union_of(some_fields()), 0.3), kRegion, 3);
  EXPECT_DOUBLE_EQ(offset(ball, 0.25)->value({1.75, 0, 0}), 0.0);
  EXPECT_DOUBLE_EQ(shell(ball, 0.5)->value({1.75, 0, 0}), 0.0);
  EXPECT_DOUBLE_EQ(shell(ball, 0.5)->value({1.25, 0, 0}), 0.0);
  EXPECT_THROW((void)shell(ball, 0.0), ParameterError);
}

TEST(Support, HoldsForEveryCombinationThatKnowsOne) {
  const std::vector<FieldPtr> bounded{sphere({-1, 0, 0}, 1.2), capsule({-1, -1, 1}, {1, 1, 1}, 0.6)};
  for (const FieldPtr& field :
       {union_of(bounded), intersection_of({bounded[0], half_space({{0, 0, 1}, 0.0})}),
        difference_of(bounded[0], bounded[1]), transformed(union_of(bounded), some_rotation(1), 0.5, {0.3, 0, 0}),
        offset(bounded[0], -0.2)}) {
    ASSERT_TRUE(field->support());
    test::for_each_seed(500, [&](Seed seed) {
      Rng rng(seed, "points");
      const Vec3 p = test::random_point(rng, field->support()->grown(1.0));
      if (!field->support()->contains(p)) {
        ASSERT_GT(field->value(p), 0.0);
      }
    });
  }
  EXPECT_FALSE(union_of({bounded[0], half_space({{0, 0, 1}, 0.0})})->support());
}

TEST(Noise, PassesTheContractAndIsOfTheAmplitudeAtMost) {
  const FieldPtr ball = sphere({0, 0, 0}, 2.0);
  const FieldPtr rough = with_noise(ball, 0.3, 0.8, 5, 42);
  test::check_field_contract(*rough, kRegion, 3);
  double largest = 0.0, sum = 0.0;
  test::for_each_seed(3000, [&](Seed seed) {
    Rng rng(seed, "points");
    const Vec3 p = test::random_point(rng, kRegion);
    const double n = rough->value(p) - ball->value(p);
    largest = std::max(largest, std::abs(n));
    sum += n;
  });
  EXPECT_LE(largest, 0.3);
  EXPECT_GT(largest, 0.1);
  EXPECT_NEAR(sum / 3000, 0.0, 0.01);
  EXPECT_NE(rough->value({1, 1, 1}), with_noise(ball, 0.3, 0.8, 5, 43)->value({1, 1, 1}));
}

TEST(Noise, SlopeBoundIsNotExceededByASteepSingleOctave) {
  const FieldPtr flat = half_space({{0, 0, 1}, 0.0});
  const FieldPtr rough = with_noise(flat, 1.0, 1.0, 1, 7);
  double steepest = 0.0;
  test::for_each_seed(20'000, [&](Seed seed) {
    Rng rng(seed, "points");
    const Vec3 p = test::random_point(rng, {Vec3(-50.0), Vec3(50.0)});
    steepest = std::max(steepest, glm::length(rough->gradient(p) - flat->gradient(p)));
  });
  EXPECT_LE(steepest, rough->lipschitz() - flat->lipschitz());
  EXPECT_GT(steepest, 0.5 * (rough->lipschitz() - flat->lipschitz()));
}

TEST(Warped, PassesTheContractOnFieldsWithAndWithoutCreases) {
  for (const FieldPtr& field : {sphere({0, 0, 0}, 1.5), box_solid({Vec3(-1.2), Vec3(1.4)}), union_of(some_fields())})
    for (const int pixels : {8, 128})
      test::check_field_contract(*warped(field, {test::noise_relief(5, pixels, pixels, 2.0), 0.1}), kRegion, 1);
}

TEST(Warped, CarvesTheDepthOfTheReliefWhereTheSurfaceIsFlat) {
  const ReliefPtr relief = test::noise_relief(6, 16, 16, 2.0);
  const FieldPtr ground = warped(half_space({{0, 0, 1}, 0.0}), {relief, 0.1});
  test::for_each_seed(100, [&](Seed seed) {
    Rng rng(seed, "points");
    const Vec3 p = test::random_point(rng, {{-5, -5, 0}, {5, 5, 0}});
    ASSERT_NEAR(ground->value(p), 0.1 * (1.0 - relief->at(p.x, p.y).d), 1e-6);
  });
}

TEST(Combinations, RefuseNothingToCombineAndNullFields) {
  EXPECT_THROW((void)union_of({}), ParameterError);
  EXPECT_THROW((void)intersection_of({nullptr}), ParameterError);
  EXPECT_THROW((void)difference_of(sphere({0, 0, 0}, 1), nullptr), ParameterError);
  EXPECT_THROW((void)smooth_union_of(some_fields(), -1.0), ParameterError);
  EXPECT_THROW((void)with_noise(sphere({0, 0, 0}, 1), 1.0, 0.0, 3, 1), ParameterError);
  EXPECT_THROW((void)warped(nullptr, {}), ParameterError);
}

}  // namespace
}  // namespace outcrop

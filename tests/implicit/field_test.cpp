#include "outcrop/implicit/field.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "implicit/field_contract.h"

namespace outcrop {
namespace {

constexpr double kRadius = 2.0;

/// The least that a node of one's own needs, written as the header says.
class UserSphere : public PointField {
 public:
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override { return glm::length(p) - kRadius; }
};

const Box kRegion{Vec3(-3.0), Vec3(4.0)};

[[nodiscard]] int failures_of(const Field& field) {
  ::testing::TestPartResultArray results;
  {
    const ::testing::ScopedFakeTestPartResultReporter reporter(
        ::testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
    test::check_field_contract(field, kRegion, 2);
  }
  return results.size();
}

TEST(PointField, OfAValueAndALipschitzConstantPassesTheContract) {
  test::check_field_contract(*std::make_shared<UserSphere>(), kRegion);
}

TEST(FieldContract, CatchesALipschitzConstantTooSmall) {
  class Wrong final : public UserSphere {
    double lipschitz() const noexcept override { return 0.9; }
    Interval bound(const Box& box) const noexcept override { return std::make_shared<UserSphere>()->bound(box); }
  };
  EXPECT_GT(failures_of(*std::make_shared<Wrong>()), 0);
}

TEST(FieldContract, CatchesABoundThatMissesValues) {
  class Wrong final : public UserSphere {
    Interval bound(const Box& box) const noexcept override {
      const Interval all = UserSphere::bound(box);
      return {all.lo, all.hi - 0.1 * all.width()};
    }
  };
  EXPECT_GT(failures_of(*std::make_shared<Wrong>()), 0);
}

TEST(FieldContract, CatchesANarrowedFieldThatDiffersInItsLastBit) {
  class Wrong final : public UserSphere {
    FieldPtr narrow(const Box&) const override {
      class Off final : public UserSphere {
        double at(const Vec3& p) const noexcept override { return std::nextafter(UserSphere::at(p), 1e9); }
      };
      return std::make_shared<Off>();
    }
  };
  EXPECT_GT(failures_of(*std::make_shared<Wrong>()), 0);
}

TEST(FieldContract, CatchesABatchThatDiffersFromItsPoints) {
  class Wrong final : public Field {
   public:
    void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
      for (std::size_t i = 0; i < points.size(); ++i) values[i] = points.z[i] + (points.size() > 64 ? 1e-12 : 0.0);
      for (Vec3& gradient : gradients) gradient = {0, 0, 1};
    }
    [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }
  };
  EXPECT_GT(failures_of(*std::make_shared<Wrong>()), 0);
}

TEST(FieldContract, CatchesLabelsThatNarrowingLoses) {
  class Wrong final : public UserSphere {
    FieldPtr narrow(const Box&) const override { return std::make_shared<UserSphere>(); }
    void labels(const Points&, std::span<Label> labels) const noexcept override {
      for (Label& label : labels) label = 3;
    }
  };
  EXPECT_GT(failures_of(*std::make_shared<Wrong>()), 0);
}

TEST(FieldContract, CatchesAGradientThatPointsInwards) {
  class Wrong final : public UserSphere {
    Vec3 gradient_at(const Vec3& p) const noexcept override { return -glm::normalize(p); }
  };
  EXPECT_GT(failures_of(*std::make_shared<Wrong>()), 0);
}

}  // namespace
}  // namespace outcrop

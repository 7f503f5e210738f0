#include "outcrop/fracture/orientations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "outcrop/core/error.h"
#include "outcrop/core/rng.h"
#include "outcrop/fracture/joints.h"

namespace outcrop {
namespace {

double axis_angle(const Vec3& a, const Vec3& b) { return std::acos(std::min(1.0, std::abs(glm::dot(a, b)))); }

std::vector<Vec3> fisher_poles(const Vec3& mean, double kappa, int count, Seed seed) {
  std::vector<Vec3> poles;
  for (int i = 0; i < count; ++i) {
    Rng rng(seed, "poles", static_cast<std::uint64_t>(i));
    const Vec3 pole = fisher_direction(mean, kappa, rng);
    poles.push_back(rng.uniform() < 0.5 ? pole : -pole);  // an axis has no sign
  }
  return poles;
}

void append(std::vector<Vec3>& poles, const std::vector<Vec3>& more) {
  poles.insert(poles.end(), more.begin(), more.end());
}

std::string message_of(std::string_view text) {
  try {
    (void)parse_orientations(text, "poles.txt");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Orientations, AreThoseOfTheCompass) {
  // A bed that dips 30° towards 90 falls to the east: its upward normal leans east.
  const Vec3 n = normal_of({radians(30), radians(90)});
  EXPECT_NEAR(n.x, 0.5, 1e-12);
  EXPECT_NEAR(n.y, 0.0, 1e-12);
  EXPECT_NEAR(n.z, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(degrees(orientation_of(Vec3(0, -1, 0)).dip), 90.0, 1e-12);
  EXPECT_EQ(orientation_of(Vec3(0, 0, -1)).dip, 0.0);
  for (int dip = 0; dip <= 90; dip += 10)
    for (int direction = 0; direction < 360; direction += 30) {
      const Vec3 pole = normal_of({radians(dip), radians(direction)});
      for (const Vec3& end : {pole, -pole}) {
        const Orientation back = orientation_of(end);
        EXPECT_LT(axis_angle(normal_of(back), pole), 1e-7);
        if (dip > 0 && dip < 90) {
          EXPECT_NEAR(degrees(back.dip_direction), direction, 1e-9);
        }
      }
    }
}

TEST(Orientations, FisherEstimatesFindTheConcentrationThatWasDrawn) {
  for (const double kappa : {5.0, 10.0, 30.0, 100.0, 300.0}) {
    const int seeds = 50;
    const int count = 200;
    double sum = 0.0;
    double worst = 0.0;
    for (Seed seed = 1; seed <= seeds; ++seed) {
      Rng rng(seed, "means");
      const Vec3 mean = rng.direction();
      const AxisStatistics found = axis_statistics(fisher_poles(mean, kappa, count, seed));
      sum += found.kappa / seeds;
      worst = std::max(worst, axis_angle(found.mean, mean));
    }
    // κ̂ of N poles scatters by κ / √N; the mean of 50 by 1 % of κ. Folding axes adds 2 % at κ = 5.
    EXPECT_NEAR(sum / kappa, 1.0, kappa < 8.0 ? 0.05 : 0.03) << "kappa " << kappa;
    EXPECT_LT(worst, 4.0 / std::sqrt(kappa * count)) << "kappa " << kappa;
  }
}

TEST(Orientations, EqualPolesAndSinglePolesHaveNoScatterToEstimate) {
  const std::vector<Vec3> one(1, normal_of({0.3, 1.0}));
  EXPECT_EQ(axis_statistics(one).kappa, 0.0);
  EXPECT_EQ(axis_statistics({}).count, 0.0);
  const std::vector<Vec3> equal(5, Vec3(0, 0, 1));
  EXPECT_GT(axis_statistics(equal).kappa, 1e12);
}

TEST(Orientations, WeightsCountAsPolesDo) {
  const std::vector<Vec3> poles = fisher_poles({0, 0, 1}, 20.0, 30, 4);
  std::vector<Vec3> repeated;
  std::vector<double> weights(poles.size(), 0.0);
  for (std::size_t i = 0; i < poles.size(); i += 2) {
    repeated.push_back(poles[i]);
    weights[i] = 7.0;
  }
  const AxisStatistics a = axis_statistics(poles, weights);
  const AxisStatistics b = axis_statistics(repeated);
  EXPECT_LT(axis_angle(a.mean, b.mean), 1e-7);
  EXPECT_NEAR(a.kappa, b.kappa, 1e-9 * b.kappa);
  EXPECT_NEAR(a.count, 15.0, 1e-9);
  EXPECT_THROW((void)axis_statistics(poles, std::vector<double>(3, 1.0)), ParameterError);
}

TEST(Orientations, TerzaghiWeightsUndoTheBiasOfAScanLine) {
  EXPECT_DOUBLE_EQ(terzaghi_weight({0, 0, 1}, {0, 0, 1}), 1.0);
  EXPECT_NEAR(terzaghi_weight(normal_of({radians(60), 0.0}), {0, 0, 1}), 2.0, 1e-12);
  EXPECT_NEAR(terzaghi_weight({1, 0, 0}, {0, 0, 1}), 1.0 / std::sin(radians(15)), 1e-12);
}

// Of three sets and a tenth of random joints, over seeds: their number, means, concentrations and members.
TEST(FindJointSets, FindsTheSetsThatWereDrawn) {
  const Vec3 means[] = {normal_of({radians(85), radians(20)}), normal_of({radians(70), radians(110)}),
                        normal_of({radians(15), radians(250)})};
  const double kappas[] = {60.0, 30.0, 120.0};
  const int counts[] = {60, 50, 70};
  int right = 0;
  const int seeds = 20;
  for (Seed seed = 1; seed <= seeds; ++seed) {
    std::vector<Vec3> poles;
    for (int k = 0; k < 3; ++k) append(poles, fisher_poles(means[k], kappas[k], counts[k], 10 * seed + k));
    for (int i = 0; i < 20; ++i) {
      Rng rng(seed, "random joints", static_cast<std::uint64_t>(i));
      poles.push_back(rng.direction());
    }
    const FoundSets found = find_joint_sets(poles);
    if (found.sets.size() != 3) continue;
    ++right;
    EXPECT_GT(found.random_share, 0.02);
    EXPECT_LT(found.random_share, 0.2);
    for (int k = 0; k < 3; ++k) {
      const auto nearest = std::min_element(found.sets.begin(), found.sets.end(), [&](const auto& a, const auto& b) {
        return axis_angle(a.statistics.mean, means[k]) < axis_angle(b.statistics.mean, means[k]);
      });
      EXPECT_LT(degrees(axis_angle(nearest->statistics.mean, means[k])), 5.0);
      EXPECT_NEAR(std::log(nearest->statistics.kappa / kappas[k]), 0.0, std::log(1.8));
      EXPECT_NEAR(static_cast<double>(nearest->members.size()), counts[k], 10.0);
    }
  }
  EXPECT_GE(right, seeds - 1);
}

TEST(FindJointSets, FindsNoneInRandomPoles) {
  for (Seed seed = 1; seed <= 10; ++seed) {
    std::vector<Vec3> poles;
    for (std::uint64_t i = 0; i < 150; ++i) poles.push_back(Rng(seed, "random joints", i).direction());
    EXPECT_TRUE(find_joint_sets(poles).sets.empty()) << "seed " << seed;
  }
}

TEST(FindJointSets, GivesAsManyAsAskedFor) {
  std::vector<Vec3> poles = fisher_poles({1, 0, 0}, 50, 40, 1);
  append(poles, fisher_poles({0, 1, 0}, 50, 30, 2));
  for (const int sets : {1, 2, 3}) EXPECT_EQ(find_joint_sets(poles, {.sets = sets}).sets.size(), std::size_t(sets));
  EXPECT_THROW((void)find_joint_sets(poles, {.sets = 9}), ParameterError);
  EXPECT_TRUE(find_joint_sets({}).sets.empty());
}

TEST(FindJointSets, ReadsTheSetsOfAMeasuredOutcrop) {
  const std::filesystem::path file = std::filesystem::path(OUTCROP_SHARED_DATA) / "tables/kinematic_data1.txt";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no measured orientations at " << file;
  std::vector<Vec3> poles;
  for (const Orientation& orientation : read_orientations(file)) poles.push_back(normal_of(orientation));
  EXPECT_EQ(poles.size(), 200u);
  const FoundSets found = find_joint_sets(poles);
  // Three steep sets and one gentle one, whichever end of the table is read first.
  ASSERT_EQ(found.sets.size(), 4u);
  EXPECT_LT(found.random_share, 0.35);
  std::reverse(poles.begin(), poles.end());
  const FoundSets reversed = find_joint_sets(poles);
  ASSERT_EQ(reversed.sets.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(orientation_of(found.sets[k].statistics.mean).dip > radians(70), k < 3);
    EXPECT_LT(axis_angle(found.sets[k].statistics.mean, reversed.sets[k].statistics.mean), radians(1));
  }
}

TEST(ReadOrientations, TakesCommasBlanksAndComments) {
  const auto read = parse_orientations("# dip, dip direction\n72, 301\r\n\n 30\t 360 # a bed\n0;-4", "poles.txt");
  ASSERT_EQ(read.size(), 3u);
  EXPECT_NEAR(degrees(read[0].dip_direction), 301.0, 1e-12);
  EXPECT_EQ(read[1].dip_direction, 0.0);
  EXPECT_NEAR(degrees(read[2].dip_direction), 356.0, 1e-9);
}

TEST(ReadOrientations, NamesTheLineThatIsWrong) {
  EXPECT_EQ(message_of("72,301\n91,10\n"),
            "poles.txt:2: expected dip (0 to 90) and dip direction (0 to 360) in degrees, got \"91,10\"");
  for (const char* text : {"10", "10,20,30", "ten,20", "10,20x", "10,721", "-1,0", "nan,3", "1e999 2"})
    EXPECT_EQ(message_of(text).rfind("poles.txt:1: expected dip", 0), 0u) << text;
  EXPECT_NE(message_of("# nothing\n\n").find("no measurement"), std::string::npos);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/amplify/placement_rule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/scratch.h"
#include "outcrop/core/error.h"
#include "outcrop/core/image.h"
#include "outcrop/core/json.h"
#include "outcrop/core/rng.h"
#include "rule_reader.h"

namespace outcrop {
namespace {

/// 41 x 41 m: a plane that falls by `slope` towards an azimuth, with a cap of curvature `curvature` about its middle.
Heightfield ground(double slope, double azimuth, double curvature = 0.0) {
  ElevationGrid grid{.width = 41, .height = 41, .origin = Vec2(500.0, 900.0), .georeferenced = true};
  for (int row = 0; row < 41; ++row)
    for (int column = 0; column < 41; ++column) {
      const Vec2 p(column - 20.0, 20.0 - row);
      const double fall = std::tan(slope) * glm::dot(p, Vec2(std::sin(azimuth), std::cos(azimuth)));
      grid.elevations.push_back(static_cast<float>(100.0 - fall - 0.5 * curvature * glm::dot(p, p)));
    }
  return Heightfield(std::move(grid));
}

class PlacementRules : public testing::Test {
 protected:
  [[nodiscard]] RuleValue value_of(const std::string& json, const Heightfield& heightfield) const {
    return rule_value(read_rule(parse_json(json, "rules.json"), {"chalk", "flint"}, folder_.path()), heightfield, 4.0);
  }
  [[nodiscard]] double at(const std::string& json, const RuleSite& site,
                          const Heightfield& heightfield = ground(radians(50.0), radians(70.0))) const {
    return value_of(json, heightfield)(site);
  }
  [[nodiscard]] std::string error_of(const std::string& json) const {
    return test::message_of<InputError>([&] { (void)at(json, middle_); });
  }

  test::Scratch folder_;
  RuleSite middle_{.position = Vec3(520.0, 920.0, 100.0), .ground = Vec2(520.0, 920.0), .distance = {}, .material = 1};
};

TEST_F(PlacementRules, GrowFromTheEndsOfTheirRangeInwards) {
  const auto altitude = [&](double z) {
    RuleSite site = middle_;
    site.position.z = z;
    return at(R"({"altitude": [10, 20], "soft": 4})", site);
  };
  EXPECT_EQ(altitude(9.999), 0.0);
  EXPECT_DOUBLE_EQ(altitude(11.0), 0.25);
  EXPECT_EQ(altitude(15.0), 1.0);
  EXPECT_DOUBLE_EQ(altitude(18.0), 0.5);
  EXPECT_EQ(altitude(20.001), 0.0);
}

TEST_F(PlacementRules, SeeTheSlopeAspectAndCurvatureOfTheGround) {
  EXPECT_EQ(at(R"({"slope_deg": [49, 51]})", middle_), 1.0);
  EXPECT_EQ(at(R"({"slope_deg": [51, 90]})", middle_), 0.0);
  EXPECT_EQ(at(R"({"aspect_deg": [60, 80]})", middle_), 1.0);
  EXPECT_EQ(at(R"({"aspect_deg": [80, 60]})", middle_), 0.0);
  EXPECT_EQ(at(R"({"aspect_deg": [300, 75]})", middle_), 1.0) << "clockwise through north";
  EXPECT_NEAR(at(R"({"aspect_deg": [60, 180], "soft": 20})", middle_), 0.5, 1e-4);
  const Heightfield cap = ground(0.0, 0.0, 0.02);
  EXPECT_EQ(at(R"({"curvature": [0.019, 0.021], "scale": 8})", middle_, cap), 1.0);
  EXPECT_EQ(at(R"({"curvature": [null, 0], "scale": 8})", middle_, cap), 0.0);
}

TEST_F(PlacementRules, RegionsAreMeasuredFromTheSouthWestCorner) {
  RuleSite site = middle_;
  site.position = {512.0, 905.0, 30.0};
  EXPECT_DOUBLE_EQ(at(R"({"polygon": [[10, 0], [20, 0], [20, 10], [10, 10]], "soft": 4})", site), 0.5);
  EXPECT_EQ(at(R"({"polygon": [[0, 0], [11, 0], [11, 10]]})", site), 0.0);
  EXPECT_EQ(at(R"({"box": {"lo": [10, 0, 29], "hi": [20, 10, 31]}})", site), 1.0);
  EXPECT_EQ(at(R"({"box": {"lo": [10, 0, 31], "hi": [20, 10, 33]}})", site), 0.0);
  EXPECT_DOUBLE_EQ(at(R"({"sphere": {"centre": [12, 5, 28], "radius": 3}, "soft": 2})", site), 0.5);
  EXPECT_DOUBLE_EQ(at(R"({"water_level": 99, "height": [null, 5], "soft": 10})", {.position = {0, 0, 101}}), 0.3);
  EXPECT_EQ(at(R"({"material": "flint"})", middle_), 1.0);
  EXPECT_EQ(at(R"({"material": ["chalk"]})", middle_), 0.0);
}

TEST_F(PlacementRules, CombineByLeastLargestAndComplement) {
  const std::string low = R"({"density": 0.25, "altitude": [0, 1000]})",
                    high = R"({"density": 0.75, "altitude": [0, 1000]})";
  EXPECT_DOUBLE_EQ(at(R"({"all": [)" + low + "," + high + "]}", middle_), 0.25);
  EXPECT_DOUBLE_EQ(at(R"({"any": [)" + low + "," + high + "]}", middle_), 0.75);
  EXPECT_DOUBLE_EQ(at(R"({"not": )" + low + "}", middle_), 0.75);
  EXPECT_DOUBLE_EQ(at(R"({"density": 0.5, "any": [)" + low + "," + high + "]}", middle_), 0.375);
}

TEST_F(PlacementRules, DistanceSaysNothingOfTheGround) {
  const std::string deep = R"({"distance": [null, -2]})", never = R"({"altitude": [0, 1]})";
  EXPECT_EQ(at(deep, middle_), 1.0);
  EXPECT_EQ(at(R"({"not": )" + deep + "}", middle_), 1.0);
  EXPECT_EQ(at(R"({"all": [)" + deep + "," + never + "]}", middle_), 0.0);
  EXPECT_EQ(at(R"({"any": [)" + deep + "," + never + "]}", middle_), 1.0);
  RuleSite anchor = middle_;
  anchor.distance = -1.0;
  EXPECT_EQ(at(deep, anchor), 0.0);
  EXPECT_EQ(at(R"({"not": )" + deep + "}", anchor), 1.0);
}

TEST_F(PlacementRules, SoftValuesAreContinuousAndWithinTheUnitInterval) {
  const Heightfield heightfield = ground(radians(45.0), 1.0, 0.01);
  const RuleValue value = value_of(R"({"all": [
    {"any": [{"polygon": [[5, 5], [35, 8], [20, 20], [30, 36]], "soft": 5}, {"sphere": {"centre": [10, 30, 100], "radius": 9}, "soft": 3}]},
    {"not": {"box": {"lo": [15, 10, 90], "hi": [25, 30, 120]}, "soft": 4}}, {"slope_deg": [20, 60], "soft": 20, "scale": 5}]})",
                                   heightfield);
  Rng rng(1, "rules");
  double least = 1.0, largest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double x = rng.uniform(500.0, 540.0), y = rng.uniform(900.0, 940.0);
    const auto here = [&](double dx) {
      const double h = heightfield.at(x + dx, y).h;
      return value({.position = {x + dx, y, h}, .ground = {x + dx, y}, .distance = {}, .material = 0});
    };
    least = std::min(least, here(0.0));
    largest = std::max(largest, here(0.0));
    ASSERT_NEAR(here(0.0), here(1e-6), 1e-5);
  }
  EXPECT_EQ(least, 0.0);
  EXPECT_GT(largest, 0.8);
}

TEST_F(PlacementRules, MasksReadWhiteAsOne) {
  Image image{
      .width = 41, .height = 41, .channels = 1, .pixels = std::vector<float>(41 * 41, 0.0f), .channel_names = {"Y"}};
  image.at(20, 20) = 1.0f;
  write_image(folder_ / "mask.exr", image);
  EXPECT_DOUBLE_EQ(at(R"({"mask": "mask.exr"})", middle_), 1.0);
  middle_.position.x += 0.5;
  EXPECT_DOUBLE_EQ(at(R"({"mask": "mask.exr"})", middle_), 0.5);
}

TEST_F(PlacementRules, MistakesAreNamedWithTheirPlace) {
  write_image(
      folder_ / "small.exr",
      {.width = 30, .height = 20, .channels = 1, .pixels = std::vector<float>(600, 1.0f), .channel_names = {"Y"}});
  struct Mistake {
    const char* text;
    std::vector<std::string> says;
  };
  const Mistake mistakes[] = {
      {"{}", {":1:1:", "slope_deg", "none"}},
      {"{\"slop_deg\": [1, 2]}", {":1:2:", "slope_deg"}},
      {"{\"altitude\": [1, 2],\n \"slope_deg\": [1, 2]}", {"one kind", "altitude", "slope_deg"}},
      {"{\"altitude\": [9, 3]}", {":1:2:", "altitude", "lower"}},
      {"{\"altitude\": 9}", {"altitude", "[from, to]", "9"}},
      {"{\"slope_deg\": [10, 95]}", {"slope_deg", "90", "95"}},
      {"{\"all\": []}", {"all", "list"}},
      {"{\"all\": [\n{\"not\": {\"curvature\": [1, -1]}}]}", {":2:10:", "curvature"}},
      {"{\"polygon\": [[0, 0], [1, 1]]}", {"polygon", "three", "2"}},
      {"{\"polygon\": [[0, 0], [9, 9],\n [9, 0], [0, 9]]}", {":2:2:", "cross", "side 3 across side 1"}},
      {"{\"polygon\": [[0, 0], [9, 0], [9, 9], [0, 0]]}", {"corner 4 twice"}},
      {"{\"box\": {\"lo\": [0, 0, 0], \"hi\": [1, -1, 1]}}", {"hi", "more"}},
      {"{\"sphere\": {\"centre\": [0, 0, 0]}}", {"radius"}},
      {"{\"material\": \"flynt\"}", {":1:2:", "flynt", "flint"}},
      {"{\"soft\": -1, \"altitude\": [1, 2]}", {"soft", "-1"}},
      {"{\"mask\": \"gone.png\"}", {":1:2:", "gone.png", "no file"}},
      {"{\"mask\": \"small.exr\"}", {":1:2:", "mask", "41 x 41", "30 x 20"}},
      {"{\"any\": [{\"water_level\": 4000}]}", {":1:11:", "water_level", "4000"}},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string error = error_of(mistake.text);
    EXPECT_EQ(error.find("rules.json:"), 0u) << mistake.text << "\n" << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    for (const std::string& word : mistake.says)
      EXPECT_NE(error.find(word), std::string::npos) << mistake.text << "\n" << error;
  }
}

TEST(CrossingSides, FindsThemInAnyTurnAndAcceptsSimpleOnes) {
  Rng rng(1, "polygons");
  for (int i = 0; i < 200; ++i) {
    // Corners in order of their azimuth do not cross; two of them swapped do.
    std::vector<Vec2> star;
    for (int k = 0; k < 8; ++k) {
      const double radius = rng.uniform(1.0, 5.0), azimuth = 2.0 * kPi * (k + rng.uniform(0.0, 0.8)) / 8.0;
      star.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth));
    }
    ASSERT_FALSE(crossing_sides(star));
    std::vector<Vec2> bow{star[0], star[4], star[2], star[6]};
    ASSERT_TRUE(crossing_sides(bow) || !crossing_sides({star[0], star[2], star[4], star[6]}));
  }
  EXPECT_TRUE(crossing_sides({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}})) << "a corner on another side";
}

}  // namespace
}  // namespace outcrop

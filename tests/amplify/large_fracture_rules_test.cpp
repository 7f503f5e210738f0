#include "outcrop/amplify/large_fracture_rules.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "outcrop/amplify/amplify.h"
#include "outcrop/amplify/strata_file.h"
#include "outcrop/core/error.h"

namespace outcrop {
namespace {

LargeFractureRules rules(const std::string& body) {
  return read_strata(parse_json("{\"large_fractures\": " + body + "}", "strata.json"), ".").large_fractures;
}

std::string complaint(const std::string& body) {
  try {
    (void)rules(body);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Heightfield hills() {
  ElevationGrid grid{.width = 81, .height = 81};
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column)
      grid.elevations.push_back(column < 40 ? 30.0f : std::max(0.0f, 30.0f - 6.0f * static_cast<float>(column - 40)));
  return Heightfield(std::move(grid));
}

TEST(LargeFractureRules, OfATraceFallToItsRightOnTheGround) {
  const LargeFractureRules read = rules(R"({"placed": [{"trace": [[10, 10], [10, 50]], "dip_deg": 60, "width": 1.5}]})");
  const auto drawn = large_fractures_on(read, hills(), {Vec3(0.0), Vec3(80.0, 80.0, 30.0)}, 1);
  ASSERT_EQ(drawn.size(), 1u);
  EXPECT_NEAR(drawn[0].radius, 20.0, 1e-9);
  EXPECT_NEAR(glm::length(drawn[0].centre - Vec3(10.0, 30.0, 30.0)), 0.0, 1e-6);
  // A trace to the north falls to the east.
  EXPECT_NEAR(glm::length(drawn[0].normal - Vec3(std::sin(radians(60.0)), 0.0, 0.5)), 0.0, 1e-9);
}

TEST(LargeFractureRules, GiveFaultsToTheStrata) {
  const LargeFracture fault{.normal = {std::sin(1.0), 0.0, std::cos(1.0)}, .radius = 40.0, .slip = 30.0};
  const LargeFracture joint{.radius = 40.0};
  const std::vector<Fault> faults = faults_of({joint, fault}, 4);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_NEAR(faults[0].dip, 1.0, 1e-12);
  EXPECT_NEAR(faults[0].dip_direction, radians(90.0), 1e-12);
  EXPECT_EQ(faults[0].slip, 20.0) << "no more than half the radius";
  EXPECT_EQ(faults[0].extent, 40.0);
}

TEST(LargeFractureRules, AreRefusedWithOneClearLine) {
  EXPECT_NE(complaint(R"({"sets": [{"dip_deg": 95}]})").find("dip_deg"), std::string::npos);
  EXPECT_NE(complaint(R"({"sets": [{"kappa": 0}]})").find("kappa"), std::string::npos);
  EXPECT_NE(complaint(R"({"sets": [{"length": [50, 20]}]})").find("the smallest before the largest"), std::string::npos);
  EXPECT_NE(complaint(R"({"sets": [{"spacing": 1, "length": [1, 9000]}]})").find("too small"), std::string::npos);
  EXPECT_NE(complaint(R"({"placed": [{"width": 1}]})").find("\"trace\" or \"centre\""), std::string::npos);
  EXPECT_NE(complaint(R"({"placed": [{"trace": [[0, 0]]}]})").find("two points"), std::string::npos);
  EXPECT_NE(complaint(R"({"placed": [{"centre": [0, 0]}]})").find("\"length\""), std::string::npos);
  EXPECT_NE(complaint(R"({"placed": [{"trace": [[0, 0], [9, 0]], "length": 3}]})").find("its own"), std::string::npos);
  EXPECT_NE(complaint(R"({"depht": 1})").find("depht"), std::string::npos);
}

TEST(LargeFractureRules, CutAGullyThroughTheWallAndLeaveThePlateau) {
  const Heightfield terrain = hills();
  StrataFile file;
  file.materials[0].tile_side = 8.0;
  file.materials[0].relief_amplitude = 0.0;
  const AmplifyOptions options{.region_lo = terrain.lo(), .region_hi = terrain.hi(), .resolution = 0.25};
  const Amplified whole = amplify(terrain, file, options);
  file.large_fractures = rules(R"({"placed": [{"centre": [42, 40, 18], "length": 50, "dip_direction_deg": 0, "width": 3}]})");
  const Amplified cut = amplify(terrain, file, options);
  int removed = 0, elsewhere = 0;
  for (double x = 40.5; x < 45.0; x += 0.5)
    for (double z = 1.0; z < 30.0; z += 0.5) {
      const double ground = whole.terrain->value({x, 40.0, z});
      if (ground > -0.5) continue;
      removed += whole.field->value({x, 40.0, z}) < 0.0 && cut.field->value({x, 40.0, z}) > 0.0;
      elsewhere += (whole.field->value({x, 46.0, z}) < 0.0) != (cut.field->value({x, 46.0, z}) < 0.0);
    }
  EXPECT_GT(removed, 20);
  EXPECT_EQ(elsewhere, 0) << "half a width from the plane nothing is removed";
  for (double x = 1.0; x < 30.0; x += 1.0)
    for (const double z : {29.0, 30.0, 31.0})
      EXPECT_EQ(cut.field->value({x, 40.0, z}), whole.terrain->value({x, 40.0, z})) << "ground that is not steep keeps its bits";
}

}  // namespace
}  // namespace outcrop

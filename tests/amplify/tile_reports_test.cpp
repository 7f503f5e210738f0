#include "outcrop/amplify/tile_reports.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/scratch.h"
#include "outcrop/amplify/run_amplify.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/core/json.h"
#include "outcrop/fracture/rock_statistics.h"

namespace outcrop {
namespace {

class TileReportsTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const std::filesystem::path path = folder_ / "strata.json";
    std::ofstream(path) << text;
    return path;
  }
  std::string error_of(const std::string& text) {
    const std::filesystem::path path = write(text);
    return test::message_of<InputError>([&] { (void)read_strata(path); });
  }

  test::Scratch folder_;
};

constexpr const char* kTwoRocks = R"({"materials": [
  {"name": "slate", "block_type": "tabular", "target": {"block_volume": 0.5}, "aperture": 0.02},
  {"name": "basalt", "block_type": "columnar", "tile_side": 12}]})";

TEST_F(TileReportsTest, NeedNoTerrain) {
  AmplifyRun run{.strata = write(kTwoRocks), .tile_reports = {folder_ / "rock.html", folder_ / "rock.json"}};
  std::vector<std::string> lines;
  (void)run_amplify(run, [&](const std::string& line) { lines.push_back(line); });
  ASSERT_EQ(lines.size(), 3u);  // the target's, and two files
  EXPECT_EQ(lines[0].rfind("material \"slate\": block_volume 0.5 m³ asked for: tile_side ", 0), 0u) << lines[0];
  const std::string page = read_text(folder_ / "rock.html");
  EXPECT_NE(page.find(">slate</text>"), std::string::npos);
  EXPECT_NE(page.find(">basalt</text>"), std::string::npos);
  const Json json = read_json(folder_ / "rock.json");
  JsonReader reader(json);
  const std::vector<Json>& rocks = reader.array("rocks");
  ASSERT_EQ(rocks.size(), 2u);
  JsonReader slate(rocks[0]);
  JsonReader volume(*slate.child("block_volume"));
  EXPECT_NEAR(volume.number("mean", 0.0), 0.5, 0.075);
  JsonReader basalt(rocks[1]);
  EXPECT_EQ(basalt.number("tile_side", 0.0), 12.0);
}

TEST_F(TileReportsTest, TargetsScaleWhatMaterialsSayInMetres) {
  const StrataFile file = read_strata(write(R"({"materials": [
    {"tile_side": 10, "sample_spacing": 0.5, "target": {"jv": 3}}, {"name": "plain"}]})"));
  const SizedStrata sized = meet_targets(file, 20.0, 5);
  const RockMaterial& material = sized.file.materials[0];
  EXPECT_EQ(sized.notes.size(), 1u);
  EXPECT_NEAR(material.sample_spacing / material.tile_side, 0.05, 1e-12);
  EXPECT_EQ(material.aperture, 0.0);  // still the default, which follows the side
  EXPECT_EQ(sized.file.materials[1].tile_side, 0.0);
  EXPECT_NEAR(measure_rock(make_tile(tile_options(material, 20.0), 5)).jv, 3.0, 0.3);
}

TEST_F(TileReportsTest, BadTargetsAreRefusedWhereTheyStand) {
  EXPECT_NE(error_of(R"({"materials": [{"target": {}}]})").find("\"block_volume\", \"jv\" or \"rqd\", got none"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"materials": [{"target": {"jv": 0}}]})").find("jv"), std::string::npos);
  EXPECT_NE(error_of(R"({"materials": [{"target": {"rqd": 120}}]})").find("rqd"), std::string::npos);
  EXPECT_NE(error_of(R"({"materials": [{"target": {"volume": 1}}]})").find("block_volume"), std::string::npos);
}

TEST_F(TileReportsTest, AreRefusedUnderOtherNamesAndWithOutputsThatNeedATerrain) {
  const auto error = [&](const AmplifyRun& run) {
    return test::message_of<ParameterError>([&] { (void)run_amplify(run); });
  };
  EXPECT_NE(error({.tile_reports = {folder_ / "rock.pdf"}}).find(".html or .json"), std::string::npos);
  EXPECT_NE(error({.meshes = {folder_ / "rock.ply"}, .tile_reports = {folder_ / "rock.html"}}).find("HEIGHTMAP"),
            std::string::npos);
  EXPECT_NE(error({}).find("HEIGHTMAP"), std::string::npos);
  EXPECT_EQ(folder_.entries(), 0u);
}

}  // namespace
}  // namespace outcrop

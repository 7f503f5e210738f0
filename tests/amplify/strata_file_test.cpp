#include "outcrop/amplify/strata_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "core/scratch.h"
#include "outcrop/core/data_path.h"
#include "outcrop/core/error.h"
#include "outcrop/core/image.h"
#include "outcrop/core/json.h"
#include "outcrop/core/rng.h"
#include "outcrop/fracture/tile.h"
#include "outcrop/implicit/relief.h"
#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop {
namespace {

class StrataFileTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const std::filesystem::path path = folder_ / "strata.json";
    std::ofstream(path) << text;
    return path;
  }
  StrataFile read(const std::string& text) { return read_strata(write(text)); }
  std::string error_of(const std::string& text) {
    const std::filesystem::path path = write(text);
    return test::message_of<InputError>([&] { (void)read_strata(path); });
  }

  test::Scratch folder_;
};

TEST_F(StrataFileTest, AnEmptyObjectMeansTheDefaults) {
  const StrataFile file = read("{}");
  ASSERT_EQ(file.materials.size(), 1u);
  EXPECT_EQ(file.materials[0].block_type, BlockType::Equidimensional);
  EXPECT_FALSE(file.materials[0].joints);
  EXPECT_TRUE(file.strata.layers.empty());
  EXPECT_EQ(file.placement.slope, Placement{}.slope);
  EXPECT_EQ(file.nodata, NodataPolicy::Hole);
}

TEST_F(StrataFileTest, EveryKeyArrives) {
  std::ofstream(folder_ / "own.png") << "not read here";
  const StrataFile file = read(R"({
    "$schema": "x", "version": 1, "description": "y",
    "materials": [
      {"name": "lower", "block_type": "tabular", "tile_side": 10, "sample_spacing": 0.5, "aperture": 0.03, "rounding": 0.2,
       "min_block_samples": 7,
       "joint_sets": [{"dip_deg": 90, "dip_direction_deg": 90, "kappa": 50, "share": 2, "radius": [1, 4]}],
       "discs": 21, "irregular_share": 0.25, "centre_spacing": 1.5, "column_width": 2,
       "relief": {"image": "own.png", "period": 2.5, "amplitude": 0.1}, "colour": [0.1, 0.2, 0.3]},
      {"name": "upper", "block_type": "columnar"}],
    "strata": {"layers": [{"material": "upper", "top": 0.25}, {"material": "lower", "top": 0.5}, {"material": "upper"}],
               "tops": "relative", "dip_deg": 12, "dip_direction_deg": 200, "undulation": 3, "undulation_wavelength": 70,
               "reference": [4, 5]},
    "placement": {"slope_deg": 50, "recess": 1.5, "distance": [-3, 0.5], "crack_depth": 0.4, "lattice_azimuth_deg": -10},
    "ground_colour": [0.4, 0.5, 0.6], "nodata": "fill"})");
  ASSERT_EQ(file.materials.size(), 2u);
  const RockMaterial& lower = file.materials[0];
  EXPECT_EQ(lower.name, "lower");
  EXPECT_EQ(lower.block_type, BlockType::Tabular);
  EXPECT_EQ(lower.tile_side, 10.0);
  EXPECT_EQ(lower.sample_spacing, 0.5);
  EXPECT_EQ(lower.aperture, 0.03);
  EXPECT_EQ(lower.rounding, 0.2);
  EXPECT_EQ(lower.min_block_samples, 7);
  EXPECT_EQ(lower.relief, folder_ / "own.png");
  EXPECT_EQ(lower.relief_period, 2.5);
  EXPECT_EQ(lower.relief_amplitude, 0.1);
  EXPECT_EQ(lower.colour, Vec3f(0.1f, 0.2f, 0.3f));
  ASSERT_TRUE(lower.joints);
  EXPECT_EQ(lower.joints->discs, 21);
  EXPECT_EQ(lower.joints->irregular_share, 0.25);
  EXPECT_EQ(lower.joints->centre_spacing, 1.5);
  ASSERT_EQ(lower.joints->columns.size(), 1u);
  EXPECT_EQ(lower.joints->columns[0].width, 2.0);
  ASSERT_EQ(lower.joints->sets.size(), 1u);
  EXPECT_EQ(lower.joints->sets[0].kappa, 50.0);
  EXPECT_EQ(lower.joints->sets[0].share, 2.0);
  EXPECT_EQ(lower.joints->sets[0].radius_lo, 1.0);
  EXPECT_EQ(lower.joints->sets[0].radius_hi, 4.0);
  EXPECT_EQ(file.materials[1].block_type, BlockType::Columnar);
  ASSERT_EQ(file.strata.layers.size(), 3u);
  EXPECT_EQ(file.strata.layers[0].material, 1);
  EXPECT_EQ(file.strata.layers[1].material, 0);
  EXPECT_EQ(file.strata.layers[1].top, 0.5);
  EXPECT_EQ(file.strata.layers[2].top, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(file.relative_tops);
  EXPECT_DOUBLE_EQ(file.strata.dip, radians(12));
  EXPECT_DOUBLE_EQ(file.strata.dip_direction, radians(200));
  EXPECT_EQ(file.strata.undulation, 3.0);
  EXPECT_EQ(file.strata.undulation_wavelength, 70.0);
  EXPECT_EQ(file.strata.reference, Vec2(4, 5));
  EXPECT_DOUBLE_EQ(file.placement.slope, radians(50));
  EXPECT_EQ(file.placement.recess, 1.5);
  EXPECT_EQ(file.placement.distance_lo, -3.0);
  EXPECT_EQ(file.placement.distance_hi, 0.5);
  EXPECT_EQ(file.placement.crack_depth, 0.4);
  EXPECT_DOUBLE_EQ(file.placement.lattice_azimuth, radians(-10));
  EXPECT_EQ(file.ground_colour, Vec3f(0.4f, 0.5f, 0.6f));
  EXPECT_EQ(file.nodata, NodataPolicy::Fill);
}

TEST_F(StrataFileTest, JointsFallTowardsTheirDipDirection) {
  const auto normal = [&](const char* angles) {
    return read(std::string(R"({"materials": [{"tile_side": 10, "irregular_share": 1, "joint_sets": [{)") + angles + "}]}]}").materials[0].joints->sets[0].normal;
  };
  EXPECT_LT(glm::length(normal(R"("dip_deg": 0)") - Vec3(0, 0, 1)), 1e-12);
  EXPECT_LT(glm::length(normal(R"("dip_deg": 90, "dip_direction_deg": 90)") - Vec3(1, 0, 0)), 1e-12) << "east";
  const Vec3 north30 = normal(R"("dip_deg": 30, "dip_direction_deg": 0)");
  // Down the dip is horizontal north and down by tan 30°: at right angles to the normal.
  EXPECT_NEAR(glm::dot(north30, Vec3(0, std::cos(radians(30)), -std::sin(radians(30)))), 0.0, 1e-12);
}

TEST_F(StrataFileTest, JointLengthsInMetresFixTheTileAtTwentyMetres) {
  EXPECT_EQ(read(R"({"materials": [{"centre_spacing": 3}]})").materials[0].tile_side, 20.0);
  EXPECT_EQ(read(R"({"materials": [{"discs": 30}]})").materials[0].tile_side, 0.0) << "counts scale along";
}

TEST_F(StrataFileTest, ReliefPeriodsDivideTheTile) {
  for (const double period : {0.3, 2.9, 3.0, 7.0, 100.0}) {
    RockMaterial material;
    material.relief_period = period;
    const double repeats = 20.0 / rock_relief(material, 20.0).period;
    EXPECT_NEAR(repeats, std::round(repeats), 1e-12);
    EXPECT_GE(repeats, 1.0);
  }
}

TEST_F(StrataFileTest, SequencesOfThicknessesRepeatFromTheirBase) {
  const StrataFile file =
      read(R"({"materials": [{"name": "a"}, {"name": "b"}], "strata": {"tops": "relative", "base": 0.5, "repeat": true,
    "layers": [{"material": "a", "thickness": [1, 2, 3]}, {"material": "b", "thickness": [4, 5]}]}})");
  ElevationGrid grid{.width = 2, .height = 2, .elevations = {100.0f, 100.0f, 120.0f, 120.0f}};
  const Strata strata = strata_on(file, Heightfield(grid));
  EXPECT_NEAR(strata.base.value(), 110.0, 1e-3);
  const double tops[] = {1, 5, 7, 12, 15, 19, 20, 25, 27, 31, 34, 39};  // 1 4, 2 5, 3 4, 1 5, 2 4, 3 5.
  ASSERT_EQ(strata.layers.size(), std::size(tops));
  for (std::size_t i = 0; i < std::size(tops); ++i) {
    EXPECT_NEAR(strata.layers[i].top, 110.0 + tops[i], 1e-3) << i;
    EXPECT_EQ(strata.layers[i].material, i % 2) << i;
  }
}

TEST_F(StrataFileTest, FoldsFaultsAndMapsArrive) {
  write_image(folder_ / "map.exr",
              {.width = 3, .height = 3, .channels = 1, .pixels = {0, 0, 0, 0, 7, 0, 0, 0, 0}, .channel_names = {"Y"}});
  const StrataFile file =
      read(R"({"materials": [{"name": "a"}, {"name": "b", "where": {"slope_deg": [60, null], "soft": 9}}], "strata": {
    "fold": {"amplitude": 3, "wavelength": 40, "axis_deg": 90},
    "faults": [{"point": [1, 2, 3], "dip_deg": 60, "dip_direction_deg": 180, "slip": -4, "extent": 20}],
    "map": {"image": "map.exr", "materials": [{"colour": 7, "material": "b"}]}}, "placement": {"rim": 2, "where": {"altitude": [null, 9]}}})");
  EXPECT_EQ(file.strata.fold.amplitude, 3.0);
  EXPECT_EQ(file.strata.fold.wavelength, 40.0);
  EXPECT_DOUBLE_EQ(file.strata.fold.axis, radians(90));
  ASSERT_EQ(file.strata.faults.size(), 1u);
  EXPECT_EQ(file.strata.faults[0].slip, -4.0);
  EXPECT_EQ(file.strata.faults[0].extent, 20.0);
  EXPECT_EQ(file.placement.rim, 2.0);
  EXPECT_EQ(file.placement.where->hi, 9.0);
  EXPECT_FALSE(file.materials[0].where);
  EXPECT_DOUBLE_EQ(file.materials[1].where->lo, radians(60));
  EXPECT_DOUBLE_EQ(file.materials[1].where->soft, radians(9));
  ElevationGrid grid{.width = 3, .height = 3, .origin = Vec2(10.0, 20.0), .elevations = std::vector<float>(9, 1.0f)};
  const Strata strata = strata_on(file, Heightfield(grid));
  EXPECT_EQ(strata.faults[0].point, Vec3(11, 22, 3));
  EXPECT_EQ(strata.material({11.0, 21.0, 0.0}), 1);
  EXPECT_EQ(strata.material({10.0, 20.0, 0.0}), 0);
  grid.width = 9, grid.elevations.resize(27, 1.0f);
  const std::string error = test::message_of<InputError>([&] { (void)strata_on(file, Heightfield(grid)); });
  EXPECT_NE(error.find("strata.json:4:13:"), std::string::npos) << error;
  EXPECT_NE(error.find("9 x 3"), std::string::npos) << error;
}

TEST_F(StrataFileTest, FinerJointsArriveAndHoldNoMoreThanAMaterialsJoints) {
  const auto finer = [](const std::string& keys) {
    return R"({"materials": [{"tile_side": 20, "finer": {)" + keys + "}}]}";
  };
  const StrataFile file = read(finer(R"("tile_side": 2, "block_type": "tabular", "aperture": 0.02)"));
  ASSERT_TRUE(file.materials[0].finer);
  EXPECT_EQ(file.materials[0].finer->tile_side, 2.0);
  EXPECT_EQ(file.materials[0].finer->block_type, BlockType::Tabular);
  EXPECT_EQ(tile_in_place(file, *file.materials[0].finer, 20.0).aperture, 0.02);
  EXPECT_NE(error_of(finer(R"("aperture": 0.02)")).find("\"tile_side\", got one without"), std::string::npos);
  EXPECT_NE(error_of(finer(R"("tile_side": 20)")).find("less than the material's own"), std::string::npos);
  for (const char* key : {"name", "colour", "target", "where", "finer"})
    EXPECT_NE(error_of(finer(R"("tile_side": 2, ")" + std::string(key) + "\": 1")).find(key), std::string::npos) << key;
}

TEST_F(StrataFileTest, ExamplesOfTheFormatsAreValid) {
  std::ifstream document(OUTCROP_SOURCE_DIR "/docs/formats.md");
  for (const char* image : {"geology.png", "bare.png"}) std::ofstream(folder_ / image) << "not read here";
  int examples = 0;
  std::string line, text;
  bool within = false;
  while (std::getline(document, line)) {
    if (within && line == "```") {
      const bool scene = text.find("\"field\"") != std::string::npos;
      EXPECT_TRUE(scene || error_of(text).empty()) << text << error_of(text);
      examples += !scene;
      within = false, text.clear();
    } else if (within) {
      text += line + "\n";
    } else {
      within = line == "```json";
    }
  }
  EXPECT_GE(examples, 3);
}

TEST_F(StrataFileTest, ShippedExamplesAreValid) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data_path() / "strata")) {
    EXPECT_NO_THROW((void)read_strata(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 3u);
}

/// Every key of the schema, with null for a value: the reader must know it and object to the null alone.
TEST_F(StrataFileTest, TheReaderKnowsEveryKeyOfTheSchema) {
  const Json schema = read_json(data_path() / "schemas" / "strata.schema.json");
  const auto member = [](const Json& json, const std::string& key) -> const Json& {
    for (const auto& [name, value] : json.members)
      if (name == key) return value;
    ADD_FAILURE() << "the schema has no " << key;
    return json;
  };
  const auto expect_known = [&](const Json& object, const std::string& before, const std::string& after) {
    for (const auto& [key, unused] : member(object, "properties").members) {
      const std::string error = error_of(before + "\"" + key + "\": null" + after);
      EXPECT_NE(error, "") << key << " is null";
      EXPECT_EQ(error.find("did you mean"), std::string::npos) << error;
      EXPECT_EQ(error.find("unknown"), std::string::npos) << error;
    }
  };
  const Json& kinds = member(schema, "$defs");
  const Json& material = member(kinds, "material");
  expect_known(schema, "{", "}");
  expect_known(material, R"({"materials": [{)", "}]}");
  expect_known(member(member(material, "properties"), "relief"), R"({"materials": [{"relief": {)", "}}]}");
  expect_known(member(kinds, "joint_set"), R"({"materials": [{"joint_sets": [{)", "}]}]}");
  expect_known(member(kinds, "strata"), R"({"strata": {)", "}}");
  expect_known(member(kinds, "placement"), R"({"placement": {)", "}}");
  expect_known(member(kinds, "rule"), R"({"placement": {"where": {)", "}}}");
  expect_known(member(kinds, "layer"), R"({"strata": {"layers": [{"material": "rock", )", "}]}}");
  expect_known(member(kinds, "fold"), R"({"strata": {"fold": {)", "}}}");
  expect_known(member(kinds, "fault"), R"({"strata": {"faults": [{)", "}]}}");
  expect_known(member(kinds, "map"), R"({"strata": {"map": {)", "}}}");
}

/// Values at, near and far from every bound, in any combination: what passes the reader must not fail later.
TEST_F(StrataFileTest, EveryMaterialThatIsAcceptedMakesATile) {
  int accepted = 0;
  for (std::uint64_t seed = 0; seed < 250; ++seed) {
    Rng rng(seed, "materials");
    const double side = std::pow(10.0, rng.uniform(-1.0, 3.0));
    const bool named = rng.uniform() < 0.5;
    std::string text = R"({"materials": [{"block_type": ")" + std::string(name(kBlockTypes[seed % std::size(kBlockTypes)])) + '"';
    const auto put = [&](const char* key, double value) { text += ", \"" + std::string(key) + "\": " + std::to_string(value); };
    const auto maybe = [&](const char* key, double lo, double hi) {
      const double chance = rng.uniform();
      const double value = lo * std::pow(hi / lo, rng.uniform());
      if (chance < 0.6) put(key, chance < 0.1 ? lo : chance < 0.2 ? hi : value);
    };
    if (named) put("tile_side", side);
    put("sample_spacing", side / rng.uniform(7.5, 12.0));
    maybe("aperture", 1e-4 * side, 0.2 * side);
    maybe("rounding", 1e-6, 0.26 * side);
    maybe("irregular_share", 1e-3, 1.0);
    if (named) maybe("centre_spacing", 1e-3 * side, side);  // Lengths of joints would fix the side at 20 m.
    if (named) maybe("column_width", 0.06 * side, 0.21 * side);
    if (named && rng.uniform() < 0.5) {
      text += R"(, "joint_sets": [{"kappa": 30)";
      const double lo = rng.uniform(0.01, 2.0) * side;
      const double hi = lo * rng.uniform(1.0, 8.0);
      text += ", \"radius\": [" + std::to_string(lo) + ", " + std::to_string(hi) + "]}]";
    }
    text += R"(, "relief": {"image": "rough")";
    maybe("period", 1e-3, 10.0 * side);
    maybe("amplitude", 1e-3 * side, 0.26 * side);
    text += "}}]}";

    RockMaterial material;
    try {
      material = read_strata(parse_json(text, "strata.json"), {}, named ? 0.0 : side).materials[0];
    } catch (const InputError&) {
      continue;
    }
    ++accepted;
    const TileOptions options = tile_options(material, side);
    const RockRelief measures = rock_relief(material, options.side);
    const Image image{.width = 2, .height = 1, .channels = 1, .pixels = {0, 1}};
    const auto relief = std::make_shared<Relief>(image, measures.period);
    try {
      for (const Block& block : make_tile(options, seed).blocks)
        (void)PolytopeKernel(block.planes, block.rounding, {relief, measures.amplitude}, block.centre);
    } catch (const std::exception& error) {
      ADD_FAILURE() << text << "\n" << error.what();
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST_F(StrataFileTest, LengthsAreHeldAgainstTheTileThatTheTerrainMakes) {
  const Json json = parse_json("{\"materials\": [{},\n  {\"name\": \"slate\", \"aperture\": 0.3}]}", "strata.json");
  EXPECT_EQ(read_strata(json, {}).materials[1].aperture, 0.3);
  EXPECT_EQ(read_strata(json, {}, 20.0).materials[1].tile_side, 0.0);
  const std::string error = test::message_of<InputError>([&] { (void)read_strata(json, {}, 5.0); });
  EXPECT_EQ(error, "strata.json:2:21: \"aperture\": expected a number in [0, 0.0924556], got 0.3");
}

TEST_F(StrataFileTest, MistakesAreNamedWithTheirPlace) {
  struct Mistake {
    const char* text;
    std::vector<std::string> says;
  };
  const Mistake mistakes[] = {
      {"{\n  \"plasement\": {}}", {":2:3:", "plasement", "placement"}},
      {"{\"placement\": {\"slop_deg\": 3}}", {":1:16:", "slop_deg", "slope_deg"}},
      {"{\"placement\": {\"slope_deg\": 120}}", {"slope_deg", "89", "120"}},
      {"{\"placement\": {\"distance\": [1, -1]}}", {"distance", "lower"}},
      {"{\"placement\": 3}", {"object", "3"}},
      {"{\"version\": 2}", {"version", "1", "2"}},
      {"[]", {":1:1:", "object", "array"}},
      {"{\"materials\": []}", {"materials", "at least one"}},
      {"{\"materials\": [{\"block_type\": \"tabula\"}]}", {"block_type", "tabular"}},
      {"{\"materials\": [{\"tile_side\": -1}]}", {"tile_side", "-1"}},
      {"{\"materials\": [{\"tile_side\": 10, \"sample_spacing\": 0.001}]}", {"sample_spacing", "0.1", "0.001"}},
      {"{\"materials\": [{\"tile_side\": 10, \"sample_spacing\": 2}]}", {":1:34:", "sample_spacing", "1.25", "2"}},
      {"{\"materials\": [{\"sample_spacing\": 0.5,\n\"aperture\": 0.5}]}", {":2:1:", "aperture", "[0, 0.25]", "0.5"}},
      {"{\"materials\": [{\"tile_side\": 20, \"aperture\": 1}]}", {"aperture", "[0, 0.369822]", "1"}},
      {"{\"materials\": [{\"rounding\": 1e-9}]}", {"rounding", "1e-06"}},
      {"{\"materials\": [{\"tile_side\": 10, \"column_width\": 0.05}]}", {"column_width", "[0.369822, 2]", "0.05"}},
      {"{\"materials\": [{\"tile_side\": 10, \"relief\": {\"amplitude\": 3}}]}", {"amplitude", "2.5", "3"}},
      {"{\"materials\": [{\"joint_sets\": [{\"radius\": [1, 300]}]}]}", {"radius", "200", "300"}},
      {"{\"materials\": [{\"joint_sets\": [{\"radius\": [4, 1]}]}]}", {"radius"}},
      {"{\"materials\": [{\"relief\": {\"image\": \"ruff\"}}]}", {":1:28:", "relief", "ruff", "rough"}},
      {"{\"materials\": [{\"relief\": {\"image\": \"gone/x.png\"}}]}", {":1:28:", "relief", "gone/x.png"}},
      {"{\"materials\": [{\"colour\": [0, 0, 2]}]}", {"colour", "2"}},
      {"{\"materials\": [{\"colour\": \"red\"}]}", {"colour", "red"}},
      {"{\"materials\": [{}, {}]}", {":1:20:", "rock", "second"}},
      {"{\"strata\": {\"layers\": [{\"material\": \"marble\"}]}}", {":1:25:", "marble", "rock"}},
      {"{\"strata\": {\"layers\": [{\"top\": 3}]}}", {"material"}},
      {"{\"strata\": {\"layers\": [{\"material\": \"rock\"}, {\"material\": \"rock\"}]}}", {"top"}},
      {"{\"strata\": {\"layers\": [{\"material\": \"rock\", \"top\": 9}, {\"material\": \"rock\", \"top\": 8}]}}",
       {"top", "8"}},
      {"{\"strata\": {\"tops\": \"absolute\"}}", {"tops", "relative", "absolute"}},
      {R"({"strata": {"repeat": true}})", {":1:13:", "layers to repeat"}},
      {R"({"strata": {"repeat": true, "layers": [{"material": "rock"}]}})", {"thickness", "repeats"}},
      {R"({"strata": {"layers": [{"material": "rock", "top": 3, "thickness": 2}]}})", {"both"}},
      {R"({"strata": {"layers": [{"material": "rock", "top": 3}, {"material": "rock", "thickness": 2}]}})",
       {":1:56:", "all"}},
      {R"({"strata": {"layers": [{"material": "rock", "thickness": [2, 3]}]}})", {"thickness", "number"}},
      {R"({"strata": {"layers": [{"material": "rock", "thickness": 0}]}})", {"thickness", "0.001", "0"}},
      {R"({"strata": {"base": 5, "repeat": true, "layers": [{"material": "rock", "top": 4}]}})", {"top", "base"}},
      {R"({"strata": {"fold": {"amplitude": 50, "wavelength": 100}}})", {"quarter", "72 degrees"}},
      {R"({"strata": {"faults": [{"dip_deg": 60, "slip": 3}]}})", {":1:24:", "point"}},
      {R"({"strata": {"faults": [{"point": [0, 0, 0], "dip_deg": 91, "slip": 3}]}})", {"dip_deg", "90", "91"}},
      {R"({"strata": {"faults": [{"point": [0, 0, 0], "dip_deg": 60, "slip": -8, "extent": 10}]}})",
       {"extent", "16", "10"}},
      {R"({"strata": {"map": {"materials": []}}})", {"image"}},
      {R"({"strata": {"map": {"image": "gone.png", "materials": []}}})", {":1:21:", "gone.png"}},
      {R"({"materials": [{"where": {"altitude": [3, 1]}}]})", {":1:27:", "altitude", "lower"}},
      {R"({"placement": {"where": {"material": "rook"}}})", {":1:26:", "rook", "rock"}},
      {R"({"placement": {"rim": -1}})", {"rim", "-1"}},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string error = error_of(mistake.text);
    EXPECT_NE(error.find("strata.json:"), std::string::npos) << mistake.text << "\n" << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    for (const std::string& word : mistake.says) EXPECT_NE(error.find(word), std::string::npos) << mistake.text << "\n" << error;
  }
}

}  // namespace
}  // namespace outcrop

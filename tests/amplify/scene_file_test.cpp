#include "outcrop/amplify/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/scratch.h"
#include "outcrop/core/error.h"
#include "outcrop/core/image.h"
#include "outcrop/core/rng.h"
#include "outcrop/implicit/grid_field.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/mesh/write_mesh.h"

namespace outcrop {
namespace {

class SceneFileTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const std::filesystem::path path = folder_ / "scene.json";
    std::ofstream(path) << text;
    return path;
  }
  Scene read(const std::string& field) { return read_scene(write("{\"field\": " + field + "}")); }
  std::string error_of(const std::string& text) {
    const std::filesystem::path path = write(text);
    return test::message_of<InputError>([&] { (void)read_scene(path); });
  }

  test::Scratch folder_;
};

TEST_F(SceneFileTest, ATreeOfNodesIsTheFieldThatTheCodeWouldBuild) {
  const Scene scene = read(R"({"difference": {
    "a": {"union": [{"sphere": {"centre": [1, 2, 3], "radius": 2}}, {"box": {"lo": [-1, -1, -1], "hi": [1, 1, 1]}}]},
    "b": {"capsule": {"a": [0, 0, -2], "b": [0, 0, 2], "radius": 0.5}}}})");
  const FieldPtr ball = sphere({1, 2, 3}, 2.0), cube = box_solid({Vec3(-1), Vec3(1)});
  const FieldPtr rod = capsule({0, 0, -2}, {0, 0, 2}, 0.5);
  Rng rng(1, "scene test");
  for (int i = 0; i < 1000; ++i) {
    const double x = rng.uniform(-4, 4);
    const double y = rng.uniform(-4, 4);
    const double z = rng.uniform(-4, 4);
    const Vec3 p(x, y, z);
    ASSERT_EQ(scene.field->value(p), std::max(std::min(ball->value(p), cube->value(p)), -rod->value(p)));
  }
}

TEST_F(SceneFileTest, TransformsScaleThenTurnThenMove) {
  const Scene scene = read(R"({"transform": {"scale": 2, "axis": [0, 0, 1], "rotate_deg": 90, "translate": [10, 0, 0],
                                             "of": {"sphere": {"centre": [1, 0, 0], "radius": 0.5}}}})");
  EXPECT_NEAR(scene.field->value({10, 2, 0}), -1.0, 1e-9) << "(1, 0, 0) goes to (0, 2, 0), then to (10, 2, 0)";
}

TEST_F(SceneFileTest, HalfSpacesPassThroughTheirPointAndFaceTheirNormal) {
  const Scene scene = read(R"({"half_space": {"normal": [0, 3, 0], "point": [5, 2, 5]}})");
  EXPECT_NEAR(scene.field->value({0, 3, 0}), 1.0, 1e-12);
  EXPECT_FALSE(scene.region) << "a half-space has no extent";
}

TEST_F(SceneFileTest, TheRegionIsTheFilesElseAroundTheSolid) {
  const Box around = read(R"({"sphere": {"centre": [100, 0, 0], "radius": 2}})").region.value();
  EXPECT_LT(around.lo.x, 98.0);
  EXPECT_GT(around.lo.x, 97.5);
  EXPECT_GT(around.hi.z, 2.0);
  const Scene scene = read_scene(write(R"({"region": [[0, 1, 2], [3, 4, 5]], "resolution": 0.5, "field": {"sphere": {}}})"));
  EXPECT_EQ(scene.region->lo, Vec3(0, 1, 2));
  EXPECT_EQ(scene.region->hi, Vec3(3, 4, 5));
  EXPECT_EQ(scene.resolution, 0.5);
}

TEST_F(SceneFileTest, ASolidOfUnknownExtentIsFoundByItsBounds) {
  const Box found = read(R"({"smooth_union": {"radius": 0.5, "of": [{"sphere": {"centre": [100, 50, 3], "radius": 2}},
                                                                   {"sphere": {"centre": [103, 50, 3], "radius": 2}}]}})").region.value();
  EXPECT_LE(found.lo.x, 98.0);
  EXPECT_GE(found.lo.x, 97.0);
  EXPECT_GE(found.hi.x, 105.0);
  EXPECT_LE(found.hi.x, 106.0);
}

TEST_F(SceneFileTest, LabelsNameMaterials) {
  const Scene scene = read_scene(write(R"({"materials": [{"name": "chalk"}, {"name": "flint", "colour": [0.1, 0.1, 0.2]}],
    "field": {"union": [{"label": {"material": "chalk", "of": {"sphere": {"centre": [-3, 0, 0]}}}},
                        {"label": {"material": "flint", "of": {"sphere": {"centre": [3, 0, 0]}}}}]}})"));
  EXPECT_EQ(scene.label_names, (std::vector<std::string>{"chalk", "flint"}));
  const double x[] = {-3, 3}, zero[] = {0, 0};
  Label labels[2];
  scene.field->labels({x, zero, zero}, labels);
  EXPECT_EQ(labels[0], 0);
  EXPECT_EQ(labels[1], 1);
}

/// Every kind of node, in one scene each, so that none is forgotten in the table.
TEST_F(SceneFileTest, EveryKindIsRead) {
  PolygonizeResult ball = polygonize(*sphere(Vec3(0.0), 1.0), {.region = {Vec3(-1.5), Vec3(1.5)}, .resolution = 0.2});
  write_mesh(folder_ / "ball.ply", rebased(ball.mesh, Vec3(0.0)));
  write_vdb(folder_ / "ball.vdb", *sphere(Vec3(0.0), 1.0), {Vec3(-1.5), Vec3(1.5)}, 0.1, Vec3(0.0));
  Image heights{.width = 8, .height = 8, .channels = 1, .pixels = std::vector<float>(64, 0.0f), .channel_names = {"Y"}};
  write_image(folder_ / "flat.exr", heights);
  const std::string ball_node = R"({"sphere": {}})";
  const std::string kinds[] = {
      R"({"box": {"rounding": 0.1}})",
      R"({"capsule": {}})",
      R"({"cylinder": {}})",
      R"({"difference": {"a": )" + ball_node + R"(, "b": {"sphere": {"centre": [0, 0, 9]}}}})",
      R"({"half_space": {"point": [0, 0, 1]}})",
      R"({"heightfield": {"file": "flat.exr", "cell_size": 2, "height_offset": 1, "nodata": "fill"}})",
      R"({"intersection": [{"box": {}}, {"sphere": {}}]})",
      R"({"mesh": {"file": "ball.ply", "voxel": 0.1}})",
      R"({"noise": {"amplitude": 0.1, "wavelength": 2, "octaves": 2, "seed": 3, "of": )" + ball_node + "}}",
      R"({"offset": {"thickness": 0.1, "of": )" + ball_node + "}}",
      R"({"slab": {}})",
      R"({"smooth_difference": {"a": )" + ball_node + R"(, "b": {"sphere": {"centre": [0, 0, 9]}}}})",
      R"({"smooth_intersection": {"radius": 0.1, "of": [{"box": {}}, {"sphere": {}}]}})",
      R"({"smooth_union": {"radius": 0.1, "of": [{"box": {}}, {"sphere": {}}]}})",
      R"({"union": [{"box": {}}, {"sphere": {}}]})",
      R"({"vdb": {"file": "ball.vdb"}})",
      R"({"warp": {"relief": "rough", "amplitude": 0.05, "period": 1, "of": )" + ball_node + "}}",
  };
  for (const std::string& kind : kinds) {
    const Scene scene = read(kind);
    EXPECT_LT(scene.field->value({0.1, 0.1, 0.1}), 0.0) << kind;
    EXPECT_GT(scene.field->value({0.1, 0.1, 3.0}), 0.0) << kind;
  }
  EXPECT_LT(read(R"({"torus": {}})").field->value({1, 0, 0}), 0.0);
  EXPECT_LT(read(R"({"shell": {"of": )" + ball_node + "}}").field->value({0, 0, 1}), 0.0);
}

TEST_F(SceneFileTest, ATileIsItsBlocksAndExplodesWithoutChangingThem) {
  const std::string tile = R"({"tile": {"tile_side": 4, "sample_spacing": 0.3, "seed": 5)";
  const Scene whole = read(tile + "}}");
  const Scene exploded = read(tile + R"(, "explode": 3}})");
  const auto volume = [](const Scene& scene) {
    Rng rng(2, "volume");
    const Box box = scene.region.value();
    int inside = 0;
    constexpr int kTries = 20'000;
    for (int i = 0; i < kTries; ++i) {
      const double x = rng.uniform(box.lo.x, box.hi.x);
      const double y = rng.uniform(box.lo.y, box.hi.y);
      const double z = rng.uniform(box.lo.z, box.hi.z);
      inside += scene.field->value({x, y, z}) < 0.0;
    }
    const Vec3 size = box.size();
    return inside * size.x * size.y * size.z / kTries;
  };
  EXPECT_NEAR(volume(whole), 64.0, 12.0) << "blocks fill most of the cube";
  EXPECT_NEAR(volume(exploded), volume(whole), 0.1 * volume(whole));
}

TEST_F(SceneFileTest, MistakesAreNamedWithTheirPlace) {
  struct Mistake {
    const char* text;
    std::vector<std::string> says;
  };
  const Mistake mistakes[] = {
      {"{}", {"field"}},
      {"{\"field\": {\"spere\": {}}}", {":1:12:", "sphere", "spere"}},
      {"{\"field\": {\"sphere\": {\"raduis\": 1}}}", {":1:23:", "raduis", "radius"}},
      {"{\"field\": {\"sphere\": {\"radius\": 0}}}", {"radius", "0"}},
      {"{\"field\": {\"sphere\": {}, \"box\": {}}}", {"one key", "2"}},
      {"{\"field\": {\"union\": []}}", {"at least one"}},
      {"{\"field\": {\"offset\": {\"thickness\": 1}}}", {"of"}},
      {"{\"field\": {\"box\": {\"lo\": [2, 0, 0], \"hi\": [1, 1, 1]}}}", {":1:12:", "box"}},
      {"{\"field\": {\"torus\": {\"axis\": [0, 0, 0]}}}", {"direction"}},
      {"{\"field\": {\"vdb\": {\"file\": \"gone.vdb\"}}}", {"gone.vdb"}},
      {"{\"field\": {\"label\": {\"material\": \"x\", \"of\": {\"sphere\": {}}}}}", {"materials"}},
      {"{\"materials\": [{\"name\": \"a\"}], \"field\": {\"label\": {\"material\": \"b\", \"of\": {\"sphere\": {}}}}}", {"\"b\"", "\"a\""}},
      {"{\"region\": [[0, 0, 0], [1, 1, 0]], \"field\": {\"sphere\": {}}}", {"region"}},
      {"{\"field\": {\"sphere\": {}}, \"resolutoin\": 1}", {"resolutoin", "resolution"}},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string error = error_of(mistake.text);
    EXPECT_NE(error, "") << mistake.text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    for (const std::string& word : mistake.says) EXPECT_NE(error.find(word), std::string::npos) << mistake.text << "\n" << error;
  }
}

}  // namespace
}  // namespace outcrop

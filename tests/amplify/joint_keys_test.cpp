// The keys of strata.json that say how joints run.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/scratch.h"
#include "outcrop/amplify/strata_file.h"
#include "outcrop/core/error.h"
#include "outcrop/fracture/orientations.h"

namespace outcrop {
namespace {

class JointKeys : public testing::Test {
 protected:
  StrataFile read(const std::string& text) { return read_strata(parse_json(text, "strata.json"), folder_.path()); }
  std::string error_of(const std::string& text) {
    return test::message_of<InputError>([&] { (void)read(text); });
  }
  static std::string material(const std::string& keys) { return R"({"materials": [{)" + keys + "}]}"; }

  test::Scratch folder_;
};

// The areas of the faces of a set, as poles in the world.
AxisStatistics faces_of(const Tile& tile, int set, const Mat3& world_from_tile) {
  std::vector<Vec3> poles;
  std::vector<double> areas;
  for (const Block& block : tile.blocks)
    for (std::size_t p = 0; p < block.planes.size(); ++p) {
      const int joint = block.plane_joint[p];
      if (joint < 0 || tile.discs[static_cast<std::size_t>(joint)].set != set) continue;
      double area = 0.0;
      for (const auto& t : block.hull.triangles) {
        const Vec3& a = block.hull.vertices[t[0]];
        const Vec3 n = glm::cross(block.hull.vertices[t[1]] - a, block.hull.vertices[t[2]] - a);
        if (std::abs(block.planes[p].distance(a)) < 1e-6 && glm::dot(glm::normalize(n), block.planes[p].normal) > 1 - 1e-9)
          area += 0.5 * glm::length(n);
      }
      poles.push_back(world_from_tile * block.planes[p].normal);
      areas.push_back(area);
    }
  return axis_statistics(poles, areas);
}

TEST_F(JointKeys, AllArrive) {
  const StrataFile file = read(material(R"("tile_side": 10,
    "joint_sets": [
      {"name": "beds", "dip_deg": 5, "dip_direction_deg": 120, "frame": "bedding", "kappa": 500, "spacing": 0.8,
       "spacing_law": "lognormal", "spacing_cv": 0.4},
      {"name": "dip joints", "dip_deg": 85, "dip_direction_deg": 30, "spacing": 1.5, "spacing_law": "fixed",
       "persistence": 0.7, "radius": 2, "ends_at": ["beds"], "ends_share": 0.8},
      {"name": "strike joints", "dip_deg": 80, "dip_direction_deg": 300, "p32": 0.6, "radius": [0.5, 6],
       "radius_law": "power_law", "radius_exponent": 2.5, "ends_at": ["beds", "dip joints", "columns"]},
      {"name": "others", "dip_deg": 40, "dip_direction_deg": 10, "share": 2, "radius": [0.5, 6],
       "radius_law": "lognormal", "radius_mean": 1.5, "radius_cv": 0.8}],
    "covered_share": 0.3, "least_thickness": 0.5, "least_angle_deg": 15,
    "columns": [{"width": 1.5, "irregularity": 0.2, "height": 2}, {"width": 0.8}],
    "discs_at": [{"centre": [1, 2, 3], "dip_deg": 90, "dip_direction_deg": 90, "radius": 4}])"));
  ASSERT_TRUE(file.materials[0].joints);
  const JointPattern& joints = *file.materials[0].joints;
  ASSERT_EQ(joints.sets.size(), 4u);
  EXPECT_EQ(joints.sets[0].name, "beds");
  EXPECT_EQ(joints.sets[0].frame, JointFrame::Bedding);
  EXPECT_EQ(joints.sets[0].spacing, 0.8);
  EXPECT_EQ(joints.sets[0].spacing_law, SpacingLaw::Lognormal);
  EXPECT_EQ(joints.sets[0].spacing_cv, 0.4);
  EXPECT_EQ(joints.sets[0].radius_law, RadiusLaw::Persistent) << "a spacing alone means joints that go on";
  EXPECT_EQ(joints.sets[1].frame, JointFrame::Map);
  EXPECT_EQ(joints.sets[1].spacing_law, SpacingLaw::Fixed);
  EXPECT_EQ(joints.sets[1].persistence, 0.7);
  EXPECT_EQ(joints.sets[1].radius_law, RadiusLaw::Uniform);
  EXPECT_EQ(joints.sets[1].radius_hi, 2.0);
  EXPECT_EQ(joints.sets[1].ends_at, std::vector<std::string>{"beds"});
  EXPECT_EQ(joints.sets[1].ends_share, 0.8);
  EXPECT_EQ(joints.sets[2].p32, 0.6);
  EXPECT_EQ(joints.sets[2].radius_law, RadiusLaw::PowerLaw);
  EXPECT_EQ(joints.sets[2].radius_exponent, 2.5);
  EXPECT_EQ(joints.sets[3].share, 2.0);
  EXPECT_EQ(joints.sets[3].radius_law, RadiusLaw::Lognormal);
  EXPECT_EQ(joints.sets[3].radius_mean, 1.5);
  EXPECT_EQ(joints.sets[3].radius_cv, 0.8);
  EXPECT_EQ(joints.covered_share, 0.3);
  EXPECT_EQ(joints.least_thickness, 0.5);
  EXPECT_DOUBLE_EQ(joints.least_angle, radians(15));
  ASSERT_EQ(joints.columns.size(), 2u);
  EXPECT_EQ(joints.columns[0].width, 1.5);
  EXPECT_EQ(joints.columns[0].irregularity, 0.2);
  EXPECT_EQ(joints.columns[0].height, 2.0);
  ASSERT_EQ(joints.discs_at.size(), 1u);
  EXPECT_EQ(joints.discs_at[0].centre, Vec3(1, 2, 3));
  EXPECT_EQ(joints.discs_at[0].radius, 4.0);
  EXPECT_NEAR(joints.discs_at[0].normal.x, 1.0, 1e-12);
  EXPECT_FALSE(make_tile(tile_in_place(file, 0, 20.0), 1).blocks.empty());
}

TEST_F(JointKeys, OfTheListedTypesMakeTheTypesTilesToTheBit) {
  const StrataFile file = read(block_types_json());
  ASSERT_EQ(file.materials.size(), std::size(kBlockTypes));
  for (std::size_t m = 0; m < file.materials.size(); ++m) {
    const BlockType type = kBlockTypes[m];
    EXPECT_EQ(file.materials[m].name, name(type));
    const Tile listed = make_tile(tile_in_place(file, m, 5.0), 3);
    const Tile own = make_tile({.type = type, .variants = RockMaterial{}.variants}, 3);
    ASSERT_EQ(listed.blocks.size(), own.blocks.size()) << name(type);
    for (std::size_t b = 0; b < own.blocks.size(); ++b) {
      ASSERT_EQ(listed.blocks[b].centre, own.blocks[b].centre) << name(type);
      ASSERT_EQ(listed.blocks[b].hull.vertices, own.blocks[b].hull.vertices) << name(type);
    }
  }
}

TEST_F(JointKeys, DirectionsAreThoseOfTheMapHoweverTheBedsDip) {
  const std::string sets = R"("tile_side": 20, "joint_sets": [
    {"name": "a", "dip_deg": 70, "dip_direction_deg": 200, "spacing": 2, "spacing_law": "fixed", "kappa": 2000},
    {"name": "b", "dip_deg": 85, "dip_direction_deg": 115, "spacing": 2, "spacing_law": "fixed", "kappa": 2000},
    {"name": "c", "dip_deg": 15, "dip_direction_deg": 350, "spacing": 2, "spacing_law": "fixed", "kappa": 2000}])";
  for (const int azimuth : {0, 27, 70}) {
    const StrataFile file = read(R"({"materials": [{)" + sets + R"(}], "strata": {"dip_deg": 25, "dip_direction_deg": 140},
      "placement": {"lattice_azimuth_deg": )" + std::to_string(azimuth) + "}}");
    const Tile tile = make_tile(tile_in_place(file, 0, 20.0), 1);
    const double wanted[][2] = {{70, 200}, {85, 115}, {15, 350}};
    for (int set = 0; set < 3; ++set) {
      // Some two joints a set are turned to close the tile, by a few degrees each.
      const Vec3 mean = faces_of(tile, set, world_from_tile(file)).mean;
      const Vec3 asked = normal_of({radians(wanted[set][0]), radians(wanted[set][1])});
      EXPECT_GT(std::abs(glm::dot(mean, asked)), std::cos(radians(3.0))) << azimuth << ", set " << set;
    }
  }
}

TEST_F(JointKeys, TakeOrientationsFromAFile) {
  std::ofstream(folder_ / "poles.txt") << "# dip, dip direction\n80, 90\n82, 268\n85, 92\n10, 0\n88, 180\n84, 3\n";
  const StrataFile drawn =
      read(material(R"("joint_sets": [{"orientations": "poles.txt", "p32": 0.5, "radius": [3, 6]}])"));
  ASSERT_EQ(drawn.materials[0].joints->sets.size(), 1u);
  EXPECT_EQ(drawn.materials[0].joints->sets[0].measured.size(), 6u);
  EXPECT_EQ(drawn.materials[0].joints->sets[0].frame, JointFrame::Map);
  EXPECT_FALSE(make_tile(tile_in_place(drawn, 0, 20.0), 1).blocks.empty());
}

TEST_F(JointKeys, ClusterMeasuredOrientationsIntoSets) {
  const std::filesystem::path file = std::filesystem::path(OUTCROP_SHARED_DATA) / "tables" / "kinematic_data1.txt";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const StrataFile found = read(material(R"("joint_sets": {"orientations": ")" + file.string() +
                                         R"(", "clusters": 4, "spacing": 2.5, "spacing_law": "lognormal"})"));
  const JointPattern& joints = *found.materials[0].joints;
  ASSERT_EQ(joints.sets.size(), 4u);
  for (const JointSet& set : joints.sets) {
    EXPECT_EQ(set.frame, JointFrame::Map);
    EXPECT_EQ(set.spacing, 2.5);
    EXPECT_GT(set.kappa, 5.0);
  }
  EXPECT_GT(make_tile(tile_in_place(found, 0, 20.0), 1).blocks.size(), 50u);
}

TEST_F(JointKeys, MistakesAreNamedWithTheirPlace) {
  struct Mistake {
    std::string text;
    std::vector<std::string> says;
  };
  const std::string three = R"({"name": "a", "dip_deg": 90, "dip_direction_deg": 90}, {"name": "b", "dip_deg": 90}, )";
  const Mistake mistakes[] = {
      {R"("joint_sets": [{"dip_deg": 95}])", {":1:33:", "dip_deg", "[0, 90]", "95"}},
      {R"("joint_sets": [{"kappa": 0}])", {"kappa", "> 0"}},
      {R"("tile_side": 8, "joint_sets": [{"spacing": 9}])", {"spacing", "8]", "9"}},
      {R"("joint_sets": [{"spacing": 2, "p32": 1}])", {"one of", "several"}},
      {R"("joint_sets": [{"radius": "persistent"}])", {"spacing", "persistent", "neither"}},
      {R"("joint_sets": [{"radius": "endless"}])", {"persistent", "endless"}},
      {R"("joint_sets": [{"orientations": "gone.txt"}])", {":1:33:", "gone.txt", "no file"}},
      {R"("joint_sets": [{"dip_deg": 90, "dip_direction_deg": 40}])", {":1:17:", "plunges", "towards", "dip_deg"}},
      {R"("joint_sets": [{"dip_deg": 90, "dip_direction_deg": 90}, {"dip_deg": 90, "dip_direction_deg": 0}])",
       {"plunges 90", "\"dip_deg\": 0"}},
      {R"("joint_sets": [)" + three + R"({"name": "c", "ends_at": ["aa"]}])", {":1:17:", "\"aa\"", "did you mean \"a\""}},
      {R"("joint_sets": [)" + three + R"({"name": "c", "ends_at": ["columns"]}])", {"columns", "none"}},
      {R"("joint_sets": [)" + three + R"({"name": "b"}])", {"name of its own", "\"b\"", "second"}},
      {R"("joint_sets": [{"name": "a", "ends_at": ["b"]}, {"name": "b", "ends_at": ["c"]}, {"name": "c", "ends_at": ["a"]}])",
       {":1:17:", "cycle: \"a\" ends at \"b\" ends at \"c\" ends at \"a\""}},
      {R"("columns": [{"irregularity": 0.5}])", {"width", "without"}},
      {R"("columns": [{"width": 2}], "column_width": 2)", {"either", "both"}},
      {R"("discs_at": [{"radius": 2}])", {"centre"}},
      {R"("blocks": [{"at": [1, 2, 3]}])", {"box", "mesh", "parts", "none"}},
      {R"("blocks": [{"box": [1, 1, 1], "mesh": "a.obj"}])", {"several"}},
      {R"("blocks": [{"parts": []}])", {"part", "none"}},
      {R"("blocks": [{"box": [1, 1, 1], "turn": 3}])", {"turn"}},
      {R"("blocks": [{"box": [30, 1, 1]}])", {"fits the tile", "blocks[0]", "longer"}},
      {R"("blocks": [{"box": [3, 3, 3]}, {"box": [3, 3, 3], "at": [18, 20, 0]}])", {"blocks[1]", "overlaps blocks[0]"}},
      {R"("blocks": [{"box": [3, 3, 3]}], "variants": 4)", {"variants", "4"}},
      {R"("blocks": [{"mesh": "tent.obj"}])", {"closed", "tent.obj", "3 open edges"}},
      {R"("blocks": [{"mesh": "ell.obj"}])", {"convex", "ell.obj", "85 %", "parts"}},
      {R"("discs_at": [{"centre": [1, 2, 30], "radius": 2}])", {"centre", "20]", "30"}},
  };
  // A tetrahedron without a side, and a prism like an L.
  std::ofstream(folder_ / "tent.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
  std::ofstream(folder_ / "ell.obj")
      << "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
         "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n"
         "f 1 4 2\nf 2 4 3\nf 1 6 4\nf 4 6 5\nf 7 8 10\nf 8 9 10\nf 7 10 12\nf 10 11 12\n"
         "f 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";
  for (const Mistake& mistake : mistakes) {
    const std::string error = error_of(material(mistake.text));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    EXPECT_EQ(error.rfind("strata.json:", 0), 0u) << mistake.text << "\n" << error;
    for (const std::string& word : mistake.says) EXPECT_NE(error.find(word), std::string::npos) << mistake.text << "\n" << error;
  }
}

}  // namespace
}  // namespace outcrop

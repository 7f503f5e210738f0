#include "outcrop/implicit/grid_field.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "implicit/field_contract.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/core/parallel.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/implicit/primitives.h"

namespace outcrop {
namespace {

namespace fs = std::filesystem;

class GridField : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("outcrop_grid_field_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path file(const char* name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

[[nodiscard]] Mesh cube_mesh(double half, const Vec3& centre) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back(centre + half * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TEST_F(GridField, WrittenAndReadBackIsTheFieldInItsBandAndPassesTheContract) {
  const FieldPtr ball = sphere({0.3, -0.2, 0.1}, 1.5);
  const double voxel = 0.1, band = 0.3;
  const Box region{Vec3(-2.0), Vec3(2.5)};
  write_vdb(file("ball.vdb"), *ball, region, voxel, Vec3(0.0));
  const FieldPtr read = read_vdb(file("ball.vdb"));
  test::for_each_seed(2000, [&](Seed seed) {
    Rng rng(seed, "points");
    const Vec3 p = test::random_point(rng, region);
    const double expected = std::clamp(ball->value(p), -band, band);
    ASSERT_NEAR(read->value(p), expected, std::abs(expected) < 0.2 ? 2e-3 : 0.05);
  });
  EXPECT_LT(read->lipschitz(), 1.75);  // √3 at most for a distance.
  test::check_field_contract(*read, region, 3);
  ASSERT_TRUE(read->support());
  test::check_field_contract(*read, *read->support(), 2);
  EXPECT_TRUE(read->support()->contains({1.8, -0.2, 0.1}));
  EXPECT_LT(read->support()->hi.x, 1.8 + band + 9 * voxel);
}

TEST_F(GridField, BoundsExcludeTheSurfaceAwayFromItAlsoForLargeBoxes) {
  const FieldPtr ball = sphere(Vec3(0.0), 3.0);
  write_vdb(file("ball.vdb"), *ball, {Vec3(-4.0), Vec3(4.0)}, 0.05, Vec3(0.0));
  const FieldPtr read = read_vdb(file("ball.vdb"));
  EXPECT_LT(read->bound({Vec3(-1.0), Vec3(1.0)}).hi, 0.0);
  EXPECT_GT(read->bound({Vec3(10.0), Vec3(100.0)}).lo, 0.0);
  EXPECT_GT(read->bound({{3.6, -2, -2}, {6, 2, 2}}).lo, 0.0);
}

TEST_F(GridField, IsWrittenRelativeToItsOrigin) {
  const Vec3 origin{4.1e5, 5.2e6, 0.0};
  const FieldPtr ball = sphere(origin + Vec3(3, 4, 5), 1.0);
  write_vdb(file("moved.vdb"), *ball, Box{Vec3(1.5, 2.5, 3.5), Vec3(4.5, 5.5, 6.5)}.moved(origin), 0.1, origin);
  EXPECT_NEAR(read_vdb(file("moved.vdb"))->value({4.0, 4.0, 5.0}), 0.0, 2e-3);
}

TEST_F(GridField, IsClosedByTheBorderOfItsRegion) {
  const FieldPtr ground = half_space({{0, 0, 1}, 0.0});
  write_vdb(file("ground.vdb"), *ground, {Vec3(-1.0), Vec3(1.0)}, 0.1, Vec3(0.0));
  const FieldPtr read = read_vdb(file("ground.vdb"));
  EXPECT_LT(read->value({0, 0, -0.5}), 0.0);
  EXPECT_NEAR(read->value({0, 0, -1.0}), 0.0, 1e-6);
  EXPECT_GT(read->value({0, 0, -1.2}), 0.0);
  EXPECT_GT(read->value({1.2, 0, -0.5}), 0.0);
}

TEST_F(GridField, HasTheSameBytesOnOneThreadAndTwo) {
  const FieldPtr rough = with_noise(sphere(Vec3(0.0), 3.0), 0.2, 0.7, 3, 1);
  const Box region{Vec3(-4.0), Vec3(4.0)};
  {
    const ThreadLimit one(1);
    write_vdb(file("one.vdb"), *rough, region, 0.1, Vec3(0.0));
  }
  {
    const ThreadLimit two(2);
    write_vdb(file("two.vdb"), *rough, region, 0.1, Vec3(0.0));
  }
  EXPECT_EQ(read_text(file("one.vdb")), read_text(file("two.vdb")));
}

TEST_F(GridField, OfACubeMeshIsItsDistanceWhicheverWayItsTrianglesTurn) {
  const double voxel = 0.1;
  for (const Vec3& centre : {Vec3(0.0), Vec3(4.1e5, 5.2e6, 1000.0)}) {
    Mesh mesh = cube_mesh(1.0, centre);
    const FieldPtr expected = box_solid({centre - Vec3(1.0), centre + Vec3(1.0)});
    for (int turn = 0; turn < 2; ++turn) {
      const FieldPtr field = mesh_distance(mesh.vertices, mesh.triangles, voxel);
      test::for_each_seed(500, [&](Seed seed) {
        Rng rng(seed, "points");
        const Vec3 p = centre + test::random_point(rng, {Vec3(-1.2), Vec3(1.2)});
        if (std::abs(expected->value(p)) < 0.25) {
          ASSERT_NEAR(field->value(p), expected->value(p), 0.5 * voxel);
        }
        ASSERT_GE(field->value(p) * expected->value(p), -1e-2);  // Never the wrong side.
      });
      for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    }
  }
  const Mesh mesh = cube_mesh(1.0, Vec3(0.0));
  test::check_field_contract(*mesh_distance(mesh.vertices, mesh.triangles, voxel), {Vec3(-1.5), Vec3(1.5)}, 3);
}

TEST_F(GridField, RefusesFilesThatHoldNoLevelSet) {
  EXPECT_THROW((void)read_vdb(file("missing.vdb")), InputError);
  EXPECT_THROW((void)read_vdb(file("missing.vdb").parent_path()), InputError);
  std::ofstream(file("empty.vdb")).close();
  EXPECT_THROW((void)read_vdb(file("empty.vdb")), InputError);
  std::ofstream(file("text.vdb")) << "this is no grid, whatever its name says";
  EXPECT_THROW((void)read_vdb(file("text.vdb")), InputError);

  write_vdb(file("whole.vdb"), *sphere(Vec3(0.0), 1.0), {Vec3(-2.0), Vec3(2.0)}, 0.1, Vec3(0.0));
  const std::string bytes = read_text(file("whole.vdb"));
  for (const std::size_t kept : {std::size_t{40}, bytes.size() / 2, bytes.size() - 10}) {
    std::ofstream(file("truncated.vdb"), std::ios::binary) << bytes.substr(0, kept);
    try {
      (void)read_vdb(file("truncated.vdb"));
      ADD_FAILURE() << "read a file of " << kept << " of " << bytes.size() << " bytes";
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      EXPECT_NE(std::string(e.what()).find("truncated.vdb: expected"), std::string::npos) << e.what();
    }
  }
  write_vdb(file("nothing.vdb"), *sphere(Vec3(0.0), 1.0), {Vec3(5.0), Vec3(6.0)}, 0.1, Vec3(0.0));
  EXPECT_THROW((void)read_vdb(file("nothing.vdb")), InputError);
}

TEST_F(GridField, RefusesBrokenBoundsAndLeavesNoFile) {
  const FieldPtr ball = sphere(Vec3(0.0), 1.0);
  const Box region{Vec3(-2.0), Vec3(2.0)};
  EXPECT_THROW(write_vdb(file("a.vdb"), *ball, region, 0.0, Vec3(0.0)), ParameterError);
  EXPECT_THROW(write_vdb(file("a.vdb"), *ball, {}, 0.1, Vec3(0.0)), ParameterError);
  EXPECT_THROW(write_vdb(file("no/such/folder/a.vdb"), *ball, region, 0.1, Vec3(0.0)), ParameterError);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(write_vdb(file("a.vdb"), *ball, region, 0.1, Vec3(0.0), 3.0, {source.get_token(), nullptr}), Cancelled);
  EXPECT_TRUE(fs::is_empty(file("a.vdb").parent_path()));
  const Mesh mesh = cube_mesh(1.0, Vec3(0.0));
  EXPECT_THROW((void)mesh_distance(mesh.vertices, mesh.triangles, -1.0), ParameterError);
  EXPECT_THROW((void)mesh_distance({}, {}, 0.1), ParameterError);
  EXPECT_THROW((void)mesh_distance(std::span(mesh.vertices).first(4), mesh.triangles, 0.1), ParameterError);
}

}  // namespace
}  // namespace outcrop

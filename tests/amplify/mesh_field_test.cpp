#include <gtest/gtest.h>

#include "core/scratch.h"
#include "outcrop/amplify/scene_file.h"
#include "outcrop/core/error.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/mesh/write_mesh.h"

namespace outcrop {
namespace {

constexpr double kVoxel = 0.05;

/// A ball of radius 1 in cells of 0.1 m.
TriangleMesh ball() {
  const FieldPtr field = sphere(Vec3(0.0), 1.0);
  return rebased(polygonize(*field, {.region = {Vec3(-1.2), Vec3(1.2)}, .resolution = 0.1}).mesh, Vec3(0.0));
}

class MeshFieldTest : public testing::Test {
 protected:
  MeshField field_of(const TriangleMesh& mesh) {
    write_mesh(folder_ / "mesh.ply", mesh);
    return mesh_field(folder_ / "mesh.ply", kVoxel);
  }

  test::Scratch folder_;
};

TEST_F(MeshFieldTest, ClosedMeshesAreTakenWithoutAWord) {
  EXPECT_EQ(field_of(ball()).note, "");
  TriangleMesh split = ball();  // Each triangle its own corners, every other turned inside out.
  TriangleMesh soup;
  for (const auto& t : split.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : t) soup.positions.push_back(split.positions[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
    if (soup.triangles.size() % 2) std::swap(soup.triangles.back()[0], soup.triangles.back()[1]);
  }
  const MeshField field = field_of(soup);
  EXPECT_EQ(field.note, "");
  EXPECT_LT(field.field->value(Vec3(0.0)), -0.5 * kVoxel);
}

TEST_F(MeshFieldTest, AGapNarrowerThanAVoxelIsClosedAndItsEdgesCounted) {
  TriangleMesh mesh = ball();
  const auto t = mesh.triangles[7];
  Vec3f middle(0.0f);
  for (const std::uint32_t v : t) middle += mesh.positions[v] / 3.0f;
  mesh.triangles[7] = {};  // In its place one that is a little smaller: a slit all around.
  for (std::size_t i = 0; i < 3; ++i) {
    mesh.triangles[7][i] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(0.95f * mesh.positions[t[i]] + 0.05f * middle);
  }
  mesh.normals.clear();
  mesh.labels.clear();
  const MeshField field = field_of(mesh);
  EXPECT_NE(field.note.find("mesh.ply: 6 open edges: "), std::string::npos) << field.note;
  EXPECT_LT(field.field->value(Vec3(0.0)), -0.5 * kVoxel);
}

TEST_F(MeshFieldTest, AnOpenMeshThatEnclosesNothingIsRefused) {
  TriangleMesh half = ball();
  std::erase_if(half.triangles, [&](const auto& t) { return half.positions[t[0]].z > 0.3f; });
  const std::string error = test::message_of<InputError>([&] { (void)field_of(half); });
  EXPECT_NE(error.find("mesh.ply: expected a closed mesh, got "), std::string::npos) << error;
  EXPECT_NE(error.find(" open edges and nothing enclosed at a voxel of 0.05 m"), std::string::npos) << error;
}

}  // namespace
}  // namespace outcrop

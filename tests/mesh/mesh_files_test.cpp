#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "core/scratch.h"
#include "fields.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/mesh/write_mesh.h"

namespace outcrop {
namespace {

using test::message_of;
using test::Scratch;

/// A ball of two materials.
TriangleMesh two_materials() {
  TriangleMesh mesh =
      polygonize(*test::ball(Vec3(0.0), 1.0), {.region = {Vec3(-1.2), Vec3(1.2)}, .resolution = 0.15}).mesh;
  for (std::size_t v = 0; v < mesh.labels.size(); ++v) mesh.labels[v] = mesh.positions[v].x > 1.2f ? 1 : 0;
  return mesh;
}

void put(const std::filesystem::path& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

/// The message of reading `text` as a file of that name, without the folder.
std::string complaint(const std::string& name, std::string_view text) {
  const Scratch scratch;
  put(scratch / name, text);
  std::string message = message_of<InputError>([&] { (void)read_mesh(scratch / name); });
  const std::string folder = scratch.path().string() + "/";
  if (message.starts_with(folder)) message.erase(0, folder.size());
  return message;
}

TEST(MeshFiles, GivePlyBackAsItWas) {
  const Scratch scratch;
  const TriangleMesh mesh = two_materials();
  const MeshMetadata metadata{.comments = {"origin 1 2", "two\nlines"},
                              .material_names = {"granite", "coarse sand"},
                              .material_colours = {Vec3f(0.2f), Vec3f(1.0f, 0.5f, 0.0f)}};
  write_mesh(scratch / "ball.ply", mesh, metadata);
  const TriangleMesh back = read_mesh(scratch / "ball.ply");
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_EQ(back.normals, mesh.normals);
  EXPECT_EQ(back.labels, mesh.labels);
  EXPECT_EQ(back.triangles, mesh.triangles);
  const std::string bytes = read_text(scratch / "ball.ply");
  EXPECT_NE(bytes.find("\ncomment two lines\ncomment material 0 granite\n"), std::string::npos);
  EXPECT_EQ(scratch.entries(), 1u);
}

TEST(MeshFiles, GiveObjPositionsBackToTheBitAndFacesByMaterial) {
  const Scratch scratch;
  const TriangleMesh mesh = two_materials();
  write_mesh(scratch / "ball.obj", mesh, {.material_names = {"granite", "coarse sand"}});
  const TriangleMesh back = read_mesh(scratch / "ball.obj");
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_EQ(back.triangles.size(), mesh.triangles.size());
  EXPECT_TRUE(check_mesh(back).closed());
  EXPECT_NEAR(check_mesh(back).volume, check_mesh(mesh).volume, 1e-12);
  const std::string text = read_text(scratch / "ball.obj");
  const auto count = [&](std::string_view word) {
    std::size_t n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("usemtl "), 2u);
  EXPECT_EQ(count("usemtl coarse_sand\n"), 1u);
  EXPECT_EQ(count("\nvn "), mesh.positions.size());
}

TEST(MeshFiles, GiveStlBackAsAClosedMesh) {
  const Scratch scratch;
  const TriangleMesh mesh = two_materials();
  write_mesh(scratch / "ball.STL", mesh, {.comments = {std::string(200, 'x')}});
  EXPECT_EQ(std::filesystem::file_size(scratch / "ball.STL"), 84 + 50 * mesh.triangles.size());
  const TriangleMesh back = read_mesh(scratch / "ball.STL");
  EXPECT_EQ(back.positions.size(), mesh.positions.size());
  EXPECT_EQ(back.triangles.size(), mesh.triangles.size());
  EXPECT_TRUE(check_mesh(back).closed());
  EXPECT_NEAR(check_mesh(back).volume, check_mesh(mesh).volume, 1e-9);
}

TEST(MeshFiles, WriteMoreThan256MaterialsAsShorts) {
  const Scratch scratch;
  TriangleMesh mesh = two_materials();
  mesh.labels[0] = 300;
  write_mesh(scratch / "many.ply", mesh);
  EXPECT_EQ(read_mesh(scratch / "many.ply").labels, mesh.labels);
}

TEST(MeshFiles, ReadPlyOfAnyPropertyOrderTypeAndByteOrder) {
  const Scratch scratch;
  put(scratch / "text.ply",
      "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nelement extra 1\r\nproperty list uchar int numbers\r\n"
      "element vertex 4\r\nproperty uchar red\r\nproperty double z\r\nproperty float y\r\nproperty int x\r\n"
      "element face 1\r\nproperty uchar flag\r\nproperty list uchar uint vertex_index\r\nend_header\r\n"
      "2 7 8\r\n9 0.5 0 0\r\n9 0.5 0 1\r\n9 0.5 1 1\r\n9 0.5 1 0\r\n3 4 0 1 2 3\r\n");
  const TriangleMesh text = read_mesh(scratch / "text.ply");
  ASSERT_EQ(text.triangles.size(), 2u);
  EXPECT_EQ(text.positions[2], Vec3f(1, 1, 0.5));
  EXPECT_EQ(text.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));

  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\nproperty short z\n"
      "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  for (const int v : {0, 0, 0, 258, 0, 0, 0, -2, 0}) {
    big += static_cast<char>(v >> 8 & 255);
    big += static_cast<char>(v & 255);
  }
  big += std::string("\3\0\1\2", 4);
  put(scratch / "big.ply", big);
  const TriangleMesh swapped = read_mesh(scratch / "big.ply");
  EXPECT_EQ(swapped.positions[1], Vec3f(258, 0, 0));
  EXPECT_EQ(swapped.positions[2], Vec3f(0, -2, 0));
}

TEST(MeshFiles, ReadTextStlAndObjWithRelativeNumbers) {
  const Scratch scratch;
  put(scratch / "one.stl",
      "solid one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e0 0 0\n   vertex 0 +1.5 0\n"
      "  endloop\n endfacet\nendsolid one\n");
  EXPECT_EQ(read_mesh(scratch / "one.stl").positions[2], Vec3f(0, 1.5, 0));
  put(scratch / "quad.obj",
      "# quad\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0\nv 0 1 0\nvt 0 0\nf -4/1 2/1/1 3//1 -1 # all\n");
  EXPECT_EQ(read_mesh(scratch / "quad.obj").triangles.size(), 2u);
}

TEST(MeshFiles, KeepMapCoordinatesThroughAnOriginOfTheirOwn) {
  const Scratch scratch;
  put(scratch / "map.obj",
      "v 412345.125 5212345.25 1500\nv 412346.125 5212345.25 1500\nv 412345.125 5212346.5 1500\nf 1 2 3\n");
  const TriangleMesh mesh = read_mesh(scratch / "map.obj");
  EXPECT_EQ(mesh.origin + Vec3(mesh.positions[2]), Vec3(412345.125, 5212346.5, 1500));
}

TEST(MeshFiles, SayWhereAFileIsWrong) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::pair<std::string, std::string> files[] = {
      {"a.xyz", "1 2 3"},
      {"a.obj", ""},
      {"a.obj", "v 0 0\n"},
      {"a.obj", "v 0 0 nan\n"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 x\n"},
      {"a.obj", "v 0 0 0\n"},
      {"a.stl", "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"},
      {"a.stl", "nothing"},
      {"a.stl", std::string(84, '\1')},
      {"a.ply", "plx\n"},
      {"a.ply", "ply\nformat ascii 1.0\ncomment cut off\n"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n"},
      {"a.ply", header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"},
      {"a.ply", header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"},
      {"a.ply", header + "0 0 0\n1 0 0\n0 1 inf\n3 0 1 2\n"},
      {"a.ply", header + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n"},
      {"a.ply", header + "0 0 0\n1 0 0\n0 1 0\n"},
      {"a.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
       "z\nend_header\nabcdefghijklmno"},
  };
  const std::string expected[] = {
      "a.xyz: expected a mesh file: .ply, .obj or .stl, got \".xyz\"",
      "a.obj: expected a mesh, got an empty file",
      "a.obj:1: expected three coordinates after \"v\", got the end of the line",
      "a.obj:1: expected three coordinates after \"v\", got \"nan\"",
      "a.obj:4: expected a vertex number from 1 to 3, got 4",
      "a.obj:3: expected a face of three or more vertices, got 2",
      "a.obj:3: expected a vertex number, got \"x\"",
      "a.obj: expected at least one triangle, got 1 vertices and no face",
      "a.stl:6: expected three vertices a facet, got 2",
      "a.stl: expected STL, got a file that is neither its text nor its binary form",
      "a.stl: expected 16843009 triangles in 842150534 bytes of binary STL, got 84 bytes",
      "a.ply:1: expected \"ply\", got a file that is no PLY",
      "a.ply:3: expected \"end_header\", got the end of the file",
      "a.ply:3: expected as many elements as fit in the file, got 99999999999",
      "a.ply:13: expected a vertex number below 3, got 3",
      "a.ply:13: expected a vertex number below 3, got -1",
      "a.ply:12: expected a finite number, got \"inf\"",
      "a.ply:13: expected a face of three or more vertices, got 2",
      "a.ply:12: expected face 0 of 1, got the end of the file",
      "a.ply: expected more bytes, got the end of the file in vertex 1",
  };
  for (std::size_t i = 0; i < std::size(files); ++i) EXPECT_EQ(complaint(files[i].first, files[i].second), expected[i]);
}

TEST(MeshFiles, LeaveNothingBehindWhenTheyCannotBeWritten) {
  const Scratch scratch;
  const TriangleMesh mesh = two_materials();
  EXPECT_THROW(write_mesh(scratch / "ball.glb", mesh), ParameterError);
  EXPECT_THROW(write_mesh(scratch / "missing" / "ball.ply", mesh), ParameterError);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(write_mesh(scratch / "ball.ply", mesh, {}, {.stop = source.get_token()}), Cancelled);
  EXPECT_EQ(scratch.entries(), 0u);
}

TEST(MeshFiles, AgreeWithTheSharedMeshesAboutTheirTopology) {
  const std::filesystem::path folder = std::filesystem::path(OUTCROP_SHARED_DATA) / "mesh";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no shared data at " << folder;
  std::size_t read = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".ply" && extension != ".obj" && extension != ".stl") continue;
    if (entry.path().string().find("otira") != std::string::npos) {
      EXPECT_NE(message_of<InputError>([&] { (void)read_mesh(entry.path()); }).find("no face"), std::string::npos);
      continue;
    }
    const MeshCheck check = check_mesh(read_mesh(entry.path()));
    EXPECT_TRUE(check.closed()) << entry.path();
    EXPECT_EQ(check.euler, 2) << entry.path();
    EXPECT_GT(check.volume, 0.0) << entry.path();
    ++read;
  }
  EXPECT_GT(read, 0u);
}

}  // namespace
}  // namespace outcrop

#include <algorithm>
#include <cctype>
#include <cmath>

#include "mesh_text.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/mesh/write_mesh.h"

namespace outcrop {
namespace {

/// Farther from the file's origin than this many times its own size, a mesh gets an origin of its own: floats would
/// lose more than 1e-4 of its size.
constexpr double kFarAway = 1000.0;
constexpr double kLargest = 1e18;

TriangleMesh to_floats(const std::filesystem::path& path, meshing::FileMesh file) {
  Box box;
  for (std::size_t v = 0; v < file.positions.size(); ++v) {
    const Vec3& p = file.positions[v];
    const bool usable = std::abs(p.x) < kLargest && std::abs(p.y) < kLargest && std::abs(p.z) < kLargest;
    if (!usable) meshing::fail(path.string(), "coordinates below 1e18", "vertex " + std::to_string(v) + " beyond");
    box.include(p);
  }
  TriangleMesh mesh;
  if (!box.empty()) {
    const Vec3 farthest = glm::max(glm::abs(box.lo), glm::abs(box.hi));
    const double extent = std::max({box.size().x, box.size().y, box.size().z});
    if (std::max({farthest.x, farthest.y, farthest.z}) > kFarAway * extent) mesh.origin = glm::floor(box.lo);
  }
  mesh.positions.reserve(file.positions.size());
  for (const Vec3& p : file.positions) mesh.positions.emplace_back(p - mesh.origin);
  mesh.normals = std::move(file.normals);
  mesh.labels = std::move(file.labels);
  mesh.triangles = std::move(file.triangles);
  return mesh;
}

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const bool ply = extension == ".ply", obj = extension == ".obj", stl = extension == ".stl";
  if (!ply && !obj && !stl) meshing::fail(path.string(), "a mesh file: .ply, .obj or .stl", meshing::quoted(extension));
  const std::string bytes = read_text(path);
  if (bytes.empty()) meshing::fail(path.string(), "a mesh", "an empty file");
  meshing::FileMesh mesh = ply   ? meshing::read_ply(path, bytes)
                           : obj ? meshing::read_obj(path, bytes)
                                 : meshing::read_stl(path, bytes);
  if (mesh.triangles.empty())
    meshing::fail(path.string(), "at least one triangle",
                  std::to_string(mesh.positions.size()) + " vertices and no face");
  return to_floats(path, std::move(mesh));
}

}  // namespace outcrop

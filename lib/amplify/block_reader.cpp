#include "block_reader.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "open_edges.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/write_mesh.h"

namespace outcrop {
namespace {

constexpr double kLeastFill = 0.98;      // Of its hull, by a mesh that counts as convex.
constexpr std::size_t kMostFaces = 64;   // Each leaves a part of the cells around it.
constexpr Bounds kSize{.lo = 0.0, .hi = 1000.0, .open_lo = true};
constexpr Bounds kPlace{-1000.0, 1000.0};
constexpr Bounds kTurn{-360.0, 360.0};

/// tile_from_block: scaled, turned about x, then y, then z, moved.
struct Pose {
  Mat3 turn_and_scale{1.0};
  Vec3 at{0.0};
};

Pose read_pose(JsonReader& reader) {
  const std::vector<double> at = reader.numbers("at", {0.0, 0.0, 0.0}, 3, kPlace);
  const std::vector<double> turn = reader.numbers("turn_deg", {0.0, 0.0, 0.0}, 3, kTurn);
  Mat3 matrix(reader.number("scale", 1.0, kSize));
  for (int axis = 0; axis < 3; ++axis) {
    const double angle = radians(turn[static_cast<std::size_t>(axis)]);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Mat3 rotation(1.0);
    rotation[u][u] = rotation[v][v] = std::cos(angle);
    rotation[u][v] = std::sin(angle);
    rotation[v][u] = -rotation[u][v];
    matrix = rotation * matrix;
  }
  return {matrix, {at[0], at[1], at[2]}};
}

std::vector<Vec3> box_corners(const std::vector<double>& size) {
  std::vector<Vec3> corners;
  for (int c = 0; c < 8; ++c)
    corners.push_back(0.5 * Vec3(c & 1 ? size[0] : -size[0], c & 2 ? size[1] : -size[1], c & 4 ? size[2] : -size[2]));
  return corners;
}

std::vector<Vec3> mesh_corners(const Json& json, const std::filesystem::path& folder) {
  if (json.type != Json::Type::String || json.string.empty()) json.fail("the path of a mesh");
  const std::filesystem::path path(json.string);
  const std::filesystem::path file = path.is_absolute() ? path : folder / path;
  const TriangleMesh mesh = read_mesh(file);
  if (const std::size_t open = count_open_edges(mesh); open > 0)
    json.fail("a closed mesh", "\"" + file.string() + "\" with " + std::to_string(open) +
                                   (open == 1 ? " open edge" : " open edges"));
  std::vector<Vec3> corners;
  for (const Vec3f& p : mesh.positions) corners.push_back(mesh.origin + Vec3(p));
  const Polytope hull = hull_polytope(corners);
  if (hull.empty()) json.fail("a mesh with an inside", "\"" + file.string() + "\", which is flat");
  const double fill = std::abs(check_mesh(mesh).volume) / hull.volume();
  if (fill < kLeastFill)
    json.fail("a convex mesh, or several as \"parts\"", "\"" + file.string() + "\", which fills " +
                                                           std::to_string(static_cast<int>(100.0 * fill)) +
                                                           " % of its hull");
  if (hull.faces.size() > kMostFaces)
    json.fail("a mesh of at most " + std::to_string(kMostFaces) + " faces",
              "\"" + file.string() + "\" with " + std::to_string(hull.faces.size()));
  return corners;
}

AuthoredBlock read_block(const Json& json, const std::filesystem::path& folder, bool is_part) {
  JsonReader reader(json);
  const Json* mesh = reader.child("mesh");
  const bool box = reader.has("box");
  const Json* parts = is_part ? nullptr : reader.child("parts");
  const std::string kinds = is_part ? "\"box\" and \"mesh\"" : "\"box\", \"mesh\" and \"parts\"";
  const int ways = (mesh != nullptr) + (parts != nullptr) + box;
  if (ways != 1) json.fail("a block with one of the keys " + kinds, ways == 0 ? "none" : "several");
  const Pose pose = read_pose(reader);
  std::vector<std::vector<Vec3>> corners;
  if (parts) {
    const std::vector<Json>& items = reader.array("parts");
    if (items.empty()) parts->fail("at least one part", "none");
    for (const Json& item : items)
      for (const Polytope& part : read_block(item, folder, true).parts) corners.push_back(part.vertices);
  } else {
    corners.push_back(mesh ? mesh_corners(*mesh, folder) : box_corners(reader.numbers("box", {}, 3, kSize)));
  }
  reader.finish();
  AuthoredBlock block;
  for (std::vector<Vec3>& part : corners) {
    for (Vec3& p : part) p = pose.at + pose.turn_and_scale * p;
    block.parts.push_back(hull_polytope(part));
  }
  return block;
}

}  // namespace

std::vector<AuthoredBlock> read_blocks(JsonReader& reader, const std::filesystem::path& folder, double side) {
  std::vector<AuthoredBlock> blocks;
  const std::vector<Json>& items = reader.array("blocks");
  for (const Json& item : items) {
    blocks.push_back(read_block(item, folder, false));
    if (side == 0.0) continue;
    if (const std::string unfit = misfit(blocks, side); !unfit.empty()) item.fail("a block that fits the tile", unfit);
  }
  return blocks;
}

}  // namespace outcrop

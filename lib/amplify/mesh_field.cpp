#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "outcrop/amplify/scene_file.h"
#include "outcrop/core/error.h"
#include "outcrop/implicit/grid_field.h"
#include "outcrop/mesh/write_mesh.h"
#include "open_edges.h"
#include "outputs.h"

namespace outcrop {
namespace {

constexpr double kMeshBand = 4.0;   // Voxels of exact distance on either side of a mesh.
constexpr double kLeastDepth = 0.5;  // Voxels: less is the crust that an open mesh leaves, 0.24 at most when tried.

/// For each vertex the first that stands at the same place: files may split vertices along seams.
std::vector<std::uint32_t> welded(const std::vector<Vec3f>& positions) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) {
    const Vec3f& p = positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i - 1]) == key(order[i]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace

std::size_t count_open_edges(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> vertex = welded(mesh.positions);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(vertex[t[i]], vertex[t[(i + 1) % 3]]);
      if (a != b) edges.emplace_back(a, b);
    }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (auto edge = edges.begin(); edge != edges.end();) {
    const auto next = std::upper_bound(edge, edges.end(), *edge);
    open += static_cast<std::size_t>(next - edge) % 2;
    edge = next;
  }
  return open;
}

MeshField mesh_field(const std::filesystem::path& path, double voxel, const Task& task) {
  const TriangleMesh mesh = read_mesh(path);
  std::vector<Vec3> vertices;
  vertices.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) vertices.push_back(mesh.origin + Vec3(p));
  const Box box = mesh.bounds();
  const Vec3 size = box.size();
  if (voxel <= 0.0) voxel = std::max({size.x, size.y, size.z}) / kDefaultCells;
  MeshField result;
  try {
    result.field = mesh_distance(vertices, mesh.triangles, voxel, kMeshBand, task);
  } catch (const ParameterError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
  const std::size_t open = count_open_edges(mesh);
  if (open == 0) return result;
  const std::string found = std::to_string(open) + (open == 1 ? " open edge" : " open edges");
  const std::string at = "a voxel of " + number_text(voxel) + " m";
  if (result.field->bound(box).lo > -kLeastDepth * voxel)
    throw InputError(path.string() + ": expected a closed mesh, got " + found + " and nothing enclosed at " + at);
  result.note = path.string() + ": " + found + ": gaps narrower than " + at +
                " are closed, what lies behind wider ones is left out";
  return result;
}

}  // namespace outcrop

#include "sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "outcrop/mesh/marching_cubes.h"
#include "roots.h"

namespace outcrop::meshing {
namespace {

/// Octree cells of 2³ levels of bricks are the unit of work: 64³ lattice cells, about ten thousand triangles.
constexpr int kChunkLevel = 3;
/// Small regions are cut finer, so that there is work for many threads.
constexpr int kLevelsAboveChunks = 3;
constexpr int kSlots = 3 * kBrickNodes * kBrickNodes * kBrickNodes;

/// What one unit of work found, bricks in Morton order.
struct Chunk {
  std::vector<Brick> bricks;
  std::vector<Vec3f> positions, normals;
  std::vector<Label> labels;
  std::size_t triangles = 0, cells = 0, evaluations = 0;
};

/// Samples the bricks of one octree cell and places the vertices on their edges.
class ChunkBuilder {
 public:
  ChunkBuilder(const Lattice& lattice, const PolygonizeOptions& options, const Task& task)
      : lattice_(lattice), options_(options), task_(task) {}

  Chunk build(const Cell& cell, int level) {
    descend(cell, level);
    return std::move(chunk_);
  }

 private:
  void descend(const Cell& cell, int level) {
    if (level > 0) {
      for (const Cell& child : split(lattice_, cell, level)) descend(child, level - 1);
      return;
    }
    task_.check();
    const FieldPtr field = cell.field->narrow(lattice_.box(cell.index, 0));
    Brick brick(lattice_, cell.index);
    chunk_.evaluations += BrickValues::count(brick);
    if (values_.sample(lattice_, *field, brick)) add(std::move(brick), *field);
  }

  void add(Brick brick, const Field& field) {
    const CubeCases& cases = CubeCases::table();
    brick.first_vertex = chunk_.positions.size();
    brick.first_triangle = chunk_.triangles;
    brick.for_each_mixed_cell([&](int, int cube_case) {
      ++chunk_.cells;
      chunk_.triangles += cases[cube_case].size();
    });
    crossings_.clear();
    const IVec3 first = brick.index * kBrickCells;
    brick.for_each_row(brick.owned, [&](int axis, int j, int k, unsigned mask) {
      constexpr int kStride[3] = {1, 9, 81};
      brick.rank[Brick::row(axis, j, k)] = static_cast<std::uint16_t>(crossings_.size());
      for (unsigned bits = brick.crossing(axis, j, k) & mask; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits), node = i + 9 * j + 81 * k;
        Crossing& c = crossings_.emplace_back();
        c.node = first + IVec3(i, j, k);
        c.axis = axis;
        c.f_a = values_.at(node);
        c.f_b = values_.at(node + kStride[axis]);
      }
    });
    place(field);
    chunk_.bricks.push_back(std::move(brick));
  }

  void place(const Field& field) {
    const std::size_t n = crossings_.size(), start = chunk_.positions.size();
    chunk_.evaluations += solver_.solve(lattice_, field, crossings_);
    for (const Crossing& c : crossings_) {
      Vec3 index(c.node);
      index[c.axis] += c.t;
      chunk_.positions.emplace_back(lattice_.local(index.x), lattice_.local(index.y), lattice_.local(index.z));
    }
    const Points places = solver_.places(lattice_, crossings_);
    if (options_.normals) {
      values_at_.resize(n);
      gradients_.resize(n);
      field.values(places, values_at_, gradients_);
      chunk_.evaluations += n;
      for (const Vec3& g : gradients_) {
        const double length = glm::length(g);
        // No gradient, no normal: left zero here and taken from the triangles later.
        chunk_.normals.push_back(length > 0.0 && std::isfinite(length) ? Vec3f(g / length) : Vec3f(0.0f));
      }
    }
    if (options_.labels) {
      chunk_.labels.resize(start + n);
      field.labels(places, std::span(chunk_.labels).subspan(start));
    }
  }

  const Lattice& lattice_;
  const PolygonizeOptions& options_;
  const Task& task_;
  Chunk chunk_;
  BrickValues values_;
  RootSolver solver_;
  std::vector<Crossing> crossings_;
  std::vector<double> values_at_;
  std::vector<Vec3> gradients_;
};

/// The case table with edges as offsets into a brick's slots: axis · 729 + node of the edge's start.
struct SlotTriangle {
  std::array<std::uint16_t, 3> slot;
};
struct SlotCases {
  std::vector<SlotTriangle> triangles;
  std::array<std::uint16_t, 257> first{};

  SlotCases() {
    for (int c = 0; c < 256; ++c) {
      first[c] = static_cast<std::uint16_t>(triangles.size());
      for (const CubeTriangle& t : CubeCases::table()[c]) {
        SlotTriangle& slots = triangles.emplace_back();
        for (int i = 0; i < 3; ++i) {
          const CubeEdge e = cube_edge(t[i]);
          slots.slot[i] = static_cast<std::uint16_t>(e.axis * 729 + e.from.x + 9 * e.from.y + 81 * e.from.z);
        }
      }
    }
    first[256] = static_cast<std::uint16_t>(triangles.size());
  }
};

std::uint64_t morton(const IVec3& index) {
  const auto spread = [](std::uint64_t v) {
    v = (v | v << 32) & 0x1f00000000ffffull;
    v = (v | v << 16) & 0x1f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    return (v | v << 2) & 0x1249249249249249ull;
  };
  return spread(index.x) | spread(index.y) << 1 | spread(index.z) << 2;
}

/// All bricks that hold rock and air, found by their place.
class BrickList {
 public:
  explicit BrickList(std::vector<Brick> bricks) : bricks_(std::move(bricks)) {
    keys_.reserve(bricks_.size());
    for (const Brick& b : bricks_) keys_.push_back(morton(b.index));
  }
  [[nodiscard]] const Brick* find(const IVec3& index) const {
    const auto at = std::lower_bound(keys_.begin(), keys_.end(), morton(index));
    return at != keys_.end() && *at == morton(index) ? &bricks_[at - keys_.begin()] : nullptr;
  }
  [[nodiscard]] const Brick& operator[](std::size_t i) const { return bricks_[i]; }

 private:
  std::vector<Brick> bricks_;
  std::vector<std::uint64_t> keys_;
};

[[noreturn]] void contradiction(const Vec3& where) {
  char place[96];
  std::snprintf(place, sizeof place, "(%.9g, %.9g, %.9g)", where.x, where.y, where.z);
  throw ParameterError(
      std::string("field: expected bound and narrow that agree with its values, got boxes that disagree near ") + place);
}

/// Writes the triangles of one brick: numbers all its crossing edges, then copies cases.
class TriangleWriter {
 public:
  TriangleWriter(const Lattice& lattice, const BrickList& bricks) : lattice_(lattice), bricks_(bricks) {}

  void write(const Brick& brick, std::array<std::uint32_t, 3>* out) {
    static const SlotCases cases;
    number_edges(brick);
    brick.for_each_mixed_cell([&](int node, int cube_case) {
      for (int i = cases.first[cube_case]; i < cases.first[cube_case + 1]; ++i) {
        const auto& slot = cases.triangles[i].slot;
        *out++ = {vertex_[slot[0] + node], vertex_[slot[1] + node], vertex_[slot[2] + node]};
      }
    });
  }

 private:
  void number_edges(const Brick& brick) {
    auto next = static_cast<std::uint32_t>(brick.first_vertex);
    std::array<const Brick*, 8> neighbours{};
    const IVec3 nodes = brick.cells + 1;
    brick.for_each_row(nodes, [&](int axis, int j, int k, unsigned mask) {
      // An edge on a far side belongs to the neighbour there, unless the lattice ends.
      const bool far_y = j >= brick.owned.y && axis != 1, far_z = k >= brick.owned.z && axis != 2;
      for (unsigned bits = brick.crossing(axis, j, k) & mask; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits);
        const bool far_x = i >= brick.owned.x && axis != 0;
        std::uint32_t& vertex = vertex_[axis * 729 + i + 9 * j + 81 * k];
        if (!far_x && !far_y && !far_z) {
          vertex = next++;
          continue;
        }
        const IVec3 step(far_x, far_y, far_z);
        const Brick*& neighbour = neighbours[step.x + 2 * step.y + 4 * step.z];
        if (!neighbour) neighbour = bricks_.find(brick.index + step);
        const IVec3 at = IVec3(i, j, k) - step * kBrickCells;
        if (!neighbour || (neighbour->crossing(axis, at.y, at.z) >> at.x & 1) == 0)
          contradiction(lattice_.node(brick.index * kBrickCells + IVec3(i, j, k)));
        vertex =
            static_cast<std::uint32_t>(neighbour->first_vertex + neighbour->vertices_before(axis, at.x, at.y, at.z));
      }
    });
  }

  const Lattice& lattice_;
  const BrickList& bricks_;
  std::array<std::uint32_t, kSlots> vertex_{};
};

std::vector<Chunk> build_chunks(const Field& field, const Lattice& lattice, const PolygonizeOptions& options,
                                const Task& task) {
  int level = root_level(lattice);
  const int chunk_level = std::clamp(level - kLevelsAboveChunks, 0, kChunkLevel);
  std::vector<Cell> cells = root_cells(lattice, field);
  for (; level > chunk_level; --level) {
    const auto parts = parallel_map(
        cells.size(), [&](std::size_t i) { return split(lattice, cells[i], level); }, task);
    cells.clear();
    for (const auto& part : parts) cells.insert(cells.end(), part.begin(), part.end());
  }
  task.begin("meshing", cells.size());
  return parallel_map(
      cells.size(),
      [&](std::size_t i) {
        Chunk chunk = ChunkBuilder(lattice, options, task).build(cells[i], level);
        cells[i].field.reset();
        task.advance();
        return chunk;
      },
      task);
}

/// Where the field has no gradient, the vertex takes the mean direction of its triangles, weighted by area.
void fill_missing_normals(TriangleMesh& mesh) {
  if (std::find(mesh.normals.begin(), mesh.normals.end(), Vec3f(0.0f)) == mesh.normals.end()) return;
  std::vector<Vec3> sums(mesh.normals.size(), Vec3(0.0));
  for (const auto& t : mesh.triangles) {
    const Vec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    for (const std::uint32_t v : t) sums[v] += glm::cross(b - a, c - a);
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    if (mesh.normals[v] != Vec3f(0.0f)) continue;
    const double length = glm::length(sums[v]);
    mesh.normals[v] = length > 0.0 ? Vec3f(sums[v] / length) : Vec3f(0, 0, 1);
  }
}

}  // namespace

PolygonizeResult mesh_sheet(const Field& field, const Lattice& lattice, const PolygonizeOptions& options,
                            const Task& task) {
  std::vector<Chunk> chunks = build_chunks(field, lattice, options, task);

  PolygonizeResult result;
  std::vector<std::size_t> first_vertex, first_brick;
  std::size_t vertices = 0, triangles = 0, brick_count = 0;
  for (Chunk& chunk : chunks) {
    for (Brick& b : chunk.bricks) {
      b.first_vertex += vertices;
      b.first_triangle += triangles;
    }
    first_vertex.push_back(vertices);
    vertices += chunk.positions.size();
    triangles += chunk.triangles;
    brick_count += chunk.bricks.size();
    result.statistics.cells += chunk.cells;
    result.statistics.evaluations += chunk.evaluations;
  }
  // Eight corners may still be added.
  require(vertices < std::numeric_limits<std::uint32_t>::max() - 8, "resolution", "at most 2^32 vertices; coarser",
          options.resolution);

  std::vector<Brick> bricks;
  bricks.reserve(brick_count);
  for (Chunk& chunk : chunks) {
    first_brick.push_back(bricks.size());
    bricks.insert(bricks.end(), chunk.bricks.begin(), chunk.bricks.end());
    chunk.bricks = {};
  }
  first_brick.push_back(bricks.size());
  const BrickList list(std::move(bricks));

  TriangleMesh& mesh = result.mesh;
  mesh.origin = lattice.lo;
  mesh.positions.resize(vertices);
  if (options.normals) mesh.normals.resize(vertices);
  if (options.labels) mesh.labels.resize(vertices);
  mesh.triangles.resize(triangles);
  parallel_for(
      chunks.size(),
      [&](std::size_t i) {
        const Chunk chunk = std::move(chunks[i]);
        std::copy(chunk.positions.begin(), chunk.positions.end(), mesh.positions.begin() + first_vertex[i]);
        std::copy(chunk.normals.begin(), chunk.normals.end(), mesh.normals.begin() + first_vertex[i]);
        std::copy(chunk.labels.begin(), chunk.labels.end(), mesh.labels.begin() + first_vertex[i]);
        TriangleWriter writer(lattice, list);
        for (std::size_t b = first_brick[i]; b < first_brick[i + 1]; ++b)
          writer.write(list[b], mesh.triangles.data() + list[b].first_triangle);
      },
      task);
  fill_missing_normals(mesh);
  return result;
}

}  // namespace outcrop::meshing

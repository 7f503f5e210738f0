/// One unit of work: the surface in one octree cell.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "brick_tree.h"
#include "cell_fan.h"
#include "flat_map.h"
#include "lattice.h"
#include "outcrop/core/task.h"
#include "outcrop/mesh/marching_cubes.h"
#include "refine.h"
#include "roots.h"
#include "transition.h"

namespace outcrop::meshing {

using Triangle = std::array<std::uint32_t, 3>;

/// A vertex on the border of a chunk. Its key is the edge that it lies on; chunks that share the edge agree on both.
struct BorderVertex {
  std::uint64_t key = 0;
  std::uint32_t vertex = 0;  ///< In the chunk.
  std::uint8_t quarters = 0; ///< How much of a turn around the edge the chunk fills.
};

/// The surface in one octree cell; vertices and triangles follow the bricks in Morton order.
struct Chunk {
  std::vector<Vec3f> positions, normals;
  std::vector<Label> labels;
  std::vector<Triangle> triangles;  ///< Of the chunk's own vertices.
  std::vector<BorderVertex> border; ///< In the order of their vertices.
  std::size_t cells = 0, evaluations = 0;
  std::array<std::size_t, kMaxLevels + 1> bricks{};  ///< With surface, by level.

  /// Keeps the memory.
  void clear();
};

/// Quarter turns around an edge inside the lattice; half as many for each side of the lattice that it lies on.
[[nodiscard]] int quarters_around(const Lattice& lattice, std::uint64_t key) noexcept;
/// The world place of an edge's middle.
[[nodiscard]] Vec3 edge_middle(const Lattice& lattice, std::uint64_t key) noexcept;
/// Throws the ParameterError that says that bound or narrow contradict the field's values near a place.
[[noreturn]] void contradiction(const Vec3& where);

/// Meshes the bricks of tree's cells, one after the other, narrowing on the way down. What it takes for a chunk serves
/// for the next; chunks do not depend on those before.
class ChunkBuilder {
 public:
  /// By BrickTree::key; need not be complete.
  using KnownCells = FlatMap<KnownCell>;
  ChunkBuilder(const Lattice& lattice, const PolygonizeOptions& options, const Task& task)
      : lattice_(lattice), options_(options), task_(task) {}
  /// Bricks of other sizes than the finest; without them cells are uniform.
  void use(const BrickTree& tree, const KnownCells& known) {
    tree_ = &tree;
    known_ = &known;
  }
  /// @throws ParameterError when two bricks disagree about an edge; Cancelled.
  [[nodiscard]] Chunk build(const Cell& cell, int level);

 private:
  void descend_uniformly(const IVec3& index, int level, const FieldPtr& narrowed);
  void descend(const Cell& cell, int level, std::span<const double> parent);
  void visit(const BrickPlace& place, const Field& field, const KnownCell* known, std::span<const double> parent);
  void mesh(const Brick& brick, const Field& field, bool transition);
  void find_vertices(const Brick& brick, bool transition);
  void emit_cells(const Brick& brick, bool transition);
  void gather_coned(const Brick& brick);
  void emit_coned(const Brick& brick, std::size_t cell);
  void emit_fans(const Brick& brick, const Field& field);
  [[nodiscard]] std::uint32_t half_vertex(const Brick& brick, const HalfEdge& edge);
  std::uint32_t vertex_on(const IVec3& from, const IVec3& along, double f_a, double f_b);
  std::uint32_t shared_vertex_on(const IVec3& from, const IVec3& along, double f_a, double f_b, std::uint64_t key,
                                 int planes);
  void place(const Field& field);
  void close_border();
  void fill_missing_normals();

  const Lattice& lattice_;
  const PolygonizeOptions& options_;
  const Task& task_;
  const BrickTree* tree_ = nullptr;
  const KnownCells* known_ = nullptr;
  Chunk chunk_;
  BrickValues values_;
  TransitionCells transition_;
  RootSolver solver_;
  CellFans fans_;
  std::vector<Apex> creases_;
  std::vector<Triangle> coned_triangles_;  ///< Of one cell, of its edges.
  std::vector<std::size_t> fan_source_;   ///< Of each fan: the first triangle that it replaces, or the coned cell.
  std::vector<BorderVertex> shared_;      ///< Vertices on faces of bricks, in order.
  FlatMap<std::uint32_t> shared_number_;  ///< By edge: the place in `shared_`, and 1.
  FlatMap<std::uint32_t> half_vertices_;  ///< Of one brick, by half edge.
  std::array<std::uint32_t, 3 * kNodes> vertex_{};
  /// Of one brick; loops around a cell's twelve edges make less than twelve triangles.
  std::vector<Triangle> brick_triangles_ = std::vector<Triangle>(kCubeEdges * kBrickCells * kBrickCells * kBrickCells);
};

}  // namespace outcrop::meshing

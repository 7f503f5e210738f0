/// The way from a field to a mesh, chunk by chunk.
#pragma once

#include <utility>

#include "assembly.h"
#include "lattice.h"
#include "outcrop/core/task.h"
#include "outcrop/mesh/polygonize.h"
#include "refine.h"

namespace outcrop::meshing {

/// Meshes a lattice, up to the point where the mesh can be emitted; `forced` splits bricks in the place of the field's
/// error. The result refers to `lattice` and `options`.
/// @throws as polygonize_pieces.
[[nodiscard]] Assembly mesh_region(const Field& field, const Lattice& lattice, const PolygonizeOptions& options,
                                   const PieceOptions& pieces, const Task& task, const ForcedSplits& forced = {});

/// Octree cells of this level are the units of work; larger ones where creases are to be joined.
[[nodiscard]] int chunk_level(const Lattice& lattice, bool crisp) noexcept;
/// Those that may hold surface, in Morton order.
[[nodiscard]] std::vector<Cell> chunk_cells(const Field& field, const Lattice& lattice, int chunk, const Task& task);

/// Collects a mesh in memory.
class MeshCollector final : public MeshSink {
 public:
  void begin(const MeshTotals& totals) override;
  void add(const MeshPiece& piece) override;
  [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }

 private:
  TriangleMesh mesh_;
};

}  // namespace outcrop::meshing

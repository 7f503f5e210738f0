/// Joins chunks to one mesh: numbers vertices, closes the region's sides, drops unwanted parts.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "border.h"
#include "chunk.h"
#include "chunk_store.h"
#include "flat_map.h"
#include "outcrop/core/task.h"
#include "parts.h"

namespace outcrop::meshing {

/// What the assembly needs to know of a chunk; found where the chunk is made, by many threads.
struct ChunkSummary {
  struct SideVertex {
    std::uint32_t vertex;  ///< Of the chunk.
    std::uint32_t part;
    Vec3f position;
  };
  std::vector<Part> parts;                 ///< One that stands for all where nobody asks for parts.
  std::vector<std::uint32_t> border_part;  ///< One a border vertex.
  std::vector<SideVertex> sides;           ///< On the lattice's sides; empty where nobody asks for walls.
  std::array<std::vector<SideCurves::Segment>, 6> segments;  ///< Of `sides`.
  Label largest_label = 0;
};

/// Which of the steps after meshing the options ask for.
struct AssemblyNeeds {
  bool walls = false;  ///< Which rock hangs together is a question to the closed mesh.
  bool parts = false;
  explicit AssemblyNeeds(const PolygonizeOptions& options) noexcept
      : walls(options.border == Border::Closed || options.parts != Parts::All || !options.keep_voids),
        parts(options.parts != Parts::All || !options.keep_voids) {}
};
[[nodiscard]] ChunkSummary summarise(const Chunk& chunk, const Lattice& lattice, const AssemblyNeeds& needs);

class Assembly {
 public:
  Assembly(const Lattice& lattice, const PolygonizeOptions& options, std::unique_ptr<ChunkStore> store)
      : lattice_(lattice), options_(options), needs_(options), store_(std::move(store)) {}

  void count_evaluations(std::size_t evaluations) noexcept { statistics_.evaluations += evaluations; }
  /// Chunks come in the order of the mesh.
  void add(Chunk chunk, ChunkSummary summary);
  /// All chunks are there: closes the sides, chooses parts. @throws ParameterError when chunks disagree about an edge.
  void finish(const Field& field, const Task& task);
  /// After finish().
  void emit(std::span<MeshSink* const> sinks, const Task& task);
  /// After finish().
  [[nodiscard]] const MeshTotals& totals() const noexcept { return totals_; }
  [[nodiscard]] const PolygonizeStatistics& statistics() const noexcept { return statistics_; }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  struct Joint {
    std::uint32_t number = 0;  ///< Part while chunks come in, vertex of the mesh while they go out.
    std::uint32_t side = kNone;
    std::uint8_t quarters = 0;
  };
  struct ChunkRecord {
    PartList::PartNumber first_part = 0;
    std::uint32_t parts = 0;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;  ///< Vertex and its number among the sides' vertices.
  };
  /// The joint of a border vertex; erased by release() when all around its edge have come.
  Joint& joint(const BorderVertex& border, bool& first);
  void release(const BorderVertex& border, const Joint& joint);
  void add_walls(const Field& field, const Task& task);
  /// The mesh's number of each vertex of the next chunk; kNone for those that go.
  template <class Keeps>
  [[nodiscard]] std::vector<std::uint32_t> numbered(const Chunk& chunk, Keeps&& keeps);
  static void drop_unnumbered(Chunk& chunk, std::vector<std::uint32_t>& numbers);
  void emit_chunk(std::size_t index, std::span<MeshSink* const> sinks);
  void emit_walls(std::span<MeshSink* const> sinks) const;
  void for_each_triangle(const PartList::Visit& visit);

  const Lattice& lattice_;
  const PolygonizeOptions& options_;
  AssemblyNeeds needs_;
  std::unique_ptr<ChunkStore> store_;
  PolygonizeStatistics statistics_;
  FlatMap<Joint> joints_;
  PartList parts_;
  std::vector<ChunkRecord> chunks_;
  SideCurves curves_;
  std::vector<std::uint32_t> side_part_, side_number_;  ///< Of the curves' vertices, then of the corners; kNone: gone.
  Walls walls_;
  PartList::PartNumber first_corner_part_ = 0;
  MeshTotals totals_;
  std::uint32_t next_number_ = 0;
};

}  // namespace outcrop::meshing

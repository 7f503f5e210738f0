/// From fields to triangle meshes.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "outcrop/core/task.h"
#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop {

/// What closes the surface where the rock reaches the border of the region.
enum class Border {
  Open,    ///< The sheet ends at the border.
  Closed,  ///< Walls and a floor: the mesh bounds the rock inside the region.
};

/// Which connected parts are kept. Closed voids inside rock are always removed unless `keep_voids`.
enum class Parts {
  All,       ///< Every part.
  Grounded,  ///< Those whose rock reaches the region's floor (z lo): nothing floats.
  Largest,   ///< The part with the largest volume.
};

/// Cells may be up to 2^8 times as long as the finest.
inline constexpr int kMaxLevels = 8;

struct PolygonizeOptions {
  /// World, finite, not empty. Its lattice starts at lo; hi is moved out to whole cells. With a tolerance, hi.z alone
  /// is, and to whole coarsest cells, while cells shrink sideways by up to a sixteenth to end at hi.x and hi.y.
  Box region;
  /// What the mesh's positions are relative to, world; null: region.lo. At most 2^17 cells away: nearer is more exact.
  /// Walls are flat and free of intersections in just these floats: a mesh that is moved and rounded again is not.
  std::optional<Vec3> origin;
  double resolution = 0.25;  ///< Edge of the finest cells in metres, > 0.
  double tolerance = 0.0;    ///< Metres, ≥ 0: how far triangles may lie off the surface where cells are not finest;
                             ///< 0: all are.
  int levels = 4;            ///< Cells are up to 2^levels times as long as the finest, 0 to 8; with a tolerance.
  std::size_t triangles = 0;  ///< About how many are wanted; 0: as many as it takes. Decides the tolerance, and the
                              ///< resolution where all finest cells would not do.
  Border border = Border::Open;
  Parts parts = Parts::All;
  bool keep_voids = false;
  bool normals = true;
  bool labels = true;
  std::size_t memory_limit =
      0;  ///< Bytes; 0: none. Exceeding it is a ParameterError that says which resolution would fit.
};

struct PolygonizeStatistics {
  std::size_t cells = 0;          ///< Cells that the surface crosses.
  std::size_t evaluations = 0;    ///< Field values computed.
  std::size_t parts_removed = 0;  ///< Floating parts.
  std::size_t voids_removed = 0;
  Box extent;  ///< What was meshed, world: the region moved out to whole cells.
  double resolution = 0.0, tolerance = 0.0;  ///< As they were, or as the wanted number of triangles made them.
  std::array<std::size_t, kMaxLevels + 1> bricks{};  ///< Of 8³ cells that the surface crosses, by level; 0: finest.
};

struct PolygonizeResult {
  TriangleMesh mesh;
  PolygonizeStatistics statistics;
};

/// The zero surface of `field` in a region: closed but for the region's border (Border::Open), manifold, oriented
/// outwards, free of intersections with itself.
///
/// Marching cubes on one integer lattice with searched tables, over bricks of 8³ cells that `bound` cannot exclude and
/// in which the field is narrowed. With a tolerance the bricks form an octree, whose neighbours differ by one level at
/// most; cells beside finer ones are coned from their centres, so there is no crack, skirt or T-junction. Where bricks
/// are split depends on the field and the lattice alone. Features thinner than a cell show where a node of the lattice
/// falls into them. Vertices lie on the surface to within a thousandth of their cell where f is smooth, and to within a
/// fiftieth where it passes that close to a node of the lattice, so that no triangle degenerates. The same bytes for any
/// number of threads. Cost: O(cells crossed) evaluations; memory O(triangles). Why it is so: docs/decisions/mesher.md.
/// @throws ParameterError also when the field's bound or narrow contradict its values; Cancelled.
[[nodiscard]] PolygonizeResult polygonize(const Field& field, const PolygonizeOptions& options, const Task& task = {});

/// What a mesh will have, told before its first piece.
struct MeshTotals {
  Vec3 origin{0.0};
  std::size_t vertices = 0, triangles = 0;
  bool normals = false, labels = false;
  Label largest_label = 0;
};

/// A stretch of a mesh. Joined in the order in which they come, pieces make the whole.
struct MeshPiece {
  std::span<const Vec3f> positions;          ///< Relative to the mesh's origin.
  std::span<const Vec3f> normals;            ///< One a vertex, or empty.
  std::span<const Label> labels;             ///< One a vertex, or empty.
  std::span<const std::uint32_t> numbers;    ///< Of each vertex in the whole mesh.
  std::uint32_t first_number = 0;  ///< Vertices of lower numbers came with earlier pieces; others are in order.
  std::span<const std::array<std::uint32_t, 3>> triangles;  ///< Of the piece's vertices.
};

/// Takes a mesh piece by piece.
class MeshSink {
 public:
  virtual ~MeshSink() = default;
  virtual void begin(const MeshTotals& totals) = 0;
  virtual void add(const MeshPiece& piece) = 0;
  virtual void end() {}
};

struct PieceOptions {
  /// Squares of 64 finest cells along the surface, about ten thousand triangles where cells are finest, that are meshed
  /// at a time; at least 1, and never less than two coarsest bricks. Decides memory and load balance, not the mesh.
  std::size_t squares = 256;
  /// A file beside which what is meshed waits on disk until it is known which parts float; empty: in memory.
  std::filesystem::path spool;
};

/// The same mesh, byte for byte, as polygonize, handed to `sinks` piece by piece: memory O(piece + region's border +
/// parts), with some 10 bytes a square.
/// @throws SystemError also when the disk is full.
PolygonizeStatistics polygonize_pieces(const Field& field, const PolygonizeOptions& options, const PieceOptions& pieces,
                                       std::span<MeshSink* const> sinks, const Task& task = {});

/// Surface cells, triangles and bytes to expect, from bounds and about a thousand sampled bricks: within some 15 %. For
/// --dry-run and memory limits.
struct PolygonizeEstimate {
  std::size_t cells = 0, triangles = 0, bytes = 0;
};
[[nodiscard]] PolygonizeEstimate estimate_polygonize(const Field& field, const PolygonizeOptions& options,
                                                     const Task& task = {});

}  // namespace outcrop

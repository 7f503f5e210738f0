/// What a mesh amounts to, told while it passes by.
#pragma once

#include <cstddef>
#include <cstdint>

#include "outcrop/mesh/polygonize.h"

namespace outcrop {

/// Counts, area and volume of a mesh that comes piece by piece, in memory that does not grow with it.
///
/// Closed means that every directed edge has its opposite, by a sum of hashes that cancel: a mesh that is open passes
/// with a probability of 2^-64. `check_mesh` says more about a mesh that is all there.
class MeshMeasure final : public MeshSink {
 public:
  void begin(const MeshTotals& totals) override;
  void add(const MeshPiece& piece) override;

  [[nodiscard]] std::size_t vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::size_t triangles() const noexcept { return triangles_; }
  [[nodiscard]] bool closed() const noexcept { return edges_ == 0; }
  [[nodiscard]] double area() const noexcept { return area_; }      ///< m².
  [[nodiscard]] double volume() const noexcept { return volume_; }  ///< Signed, m³; meaningful when closed.

 private:
  std::size_t vertices_ = 0, triangles_ = 0;
  std::uint64_t edges_ = 0;
  double area_ = 0.0, volume_ = 0.0;
};

/// Hands a mesh that is all there to a sink, in one piece.
void feed(const TriangleMesh& mesh, MeshSink& sink);

}  // namespace outcrop

#include "outcrop/mesh/mesh_measure.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <glm/geometric.hpp>

namespace outcrop {
namespace {

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014): each bit of the key moves half of the result's.
std::uint64_t hash(std::uint32_t from, std::uint32_t to) noexcept {
  std::uint64_t key = ((std::uint64_t{from} << 32) | to) + 0x9E3779B97F4A7C15ull;
  key = (key ^ (key >> 30)) * 0xBF58476D1CE4E5B9ull;
  key = (key ^ (key >> 27)) * 0x94D049BB133111EBull;
  return key ^ (key >> 31);
}

}  // namespace

void MeshMeasure::begin(const MeshTotals& totals) {
  *this = {};
  vertices_ = totals.vertices;
}

void MeshMeasure::add(const MeshPiece& piece) {
  triangles_ += piece.triangles.size();
  for (const auto& t : piece.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = piece.numbers[t[i]], b = piece.numbers[t[(i + 1) % 3]];
      edges_ += hash(a, b) - hash(b, a);
    }
    const Vec3 a(piece.positions[t[0]]), b(piece.positions[t[1]]), c(piece.positions[t[2]]);
    area_ += 0.5 * glm::length(glm::cross(b - a, c - a));
    volume_ += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
}

void feed(const TriangleMesh& mesh, MeshSink& sink) {
  std::vector<std::uint32_t> numbers(mesh.positions.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  const Label largest = mesh.labels.empty() ? Label{0} : *std::max_element(mesh.labels.begin(), mesh.labels.end());
  sink.begin({mesh.origin, mesh.positions.size(), mesh.triangles.size(), !mesh.normals.empty(), !mesh.labels.empty(),
              largest});
  sink.add({mesh.positions, mesh.normals, mesh.labels, numbers, 0, mesh.triangles});
  sink.end();
}

}  // namespace outcrop

/// Connected parts of a mesh that comes in chunks, and which of them are wanted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "border.h"
#include "chunk.h"
#include "lattice.h"
#include "outcrop/mesh/polygonize.h"
#include "union_find.h"

namespace outcrop::meshing {

/// What there is to know about a part, or about a piece of one.
struct Part {
  Vec3 origin{0.0};   ///< A vertex of the part: volumes are taken about it, so that small parts far out keep digits.
  double volume = 0.0;
  Vec3 area{0.0};     ///< Sum of the triangles' normals times areas: what moves `volume` to another origin.
  Box box;
  std::size_t vertices = 0, triangles = 0;
  bool grounded = false;
  bool keep = true;

  [[nodiscard]] bool is_void() const noexcept { return volume <= 0.0; }
  /// The triangles are not counted as the part's.
  void add_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) noexcept;
  void merge(const Part& other) noexcept;
};

/// The connected pieces of one chunk.
struct ChunkParts {
  std::vector<Part> parts;
  std::vector<std::uint32_t> part_of;  ///< One a vertex.
};
/// Parts in the order of their first vertices. Cost: O(triangles).
[[nodiscard]] ChunkParts find_parts(const Chunk& chunk, const Lattice& lattice);

/// Joins the pieces of chunks to parts and chooses among them.
class PartList {
 public:
  using PartNumber = std::uint32_t;
  /// @return the number of the first of them.
  PartNumber add(std::vector<Part> parts);
  void join(PartNumber a, PartNumber b) { sets_.join(a, b); }
  [[nodiscard]] Part& part(PartNumber number) { return parts_[number]; }
  /// Merges what was joined, and drops what `wanted` and `keep_voids` do not want. A part of negative volume is a void:
  /// it stays only with `keep_voids` and the rock around it. Rock inside a void that goes, goes too: it would end up
  /// inside rock.
  /// @param for_each_triangle  Called with visit(part number, a, b, c): visits all triangles.
  using Visit = std::function<void(PartNumber, const Vec3f&, const Vec3f&, const Vec3f&)>;
  void choose(Parts wanted, bool keep_voids, const std::function<void(const Visit&)>& for_each_triangle);
  /// After choose().
  [[nodiscard]] bool keeps(PartNumber number) { return parts_[sets_.root(number)].keep; }
  [[nodiscard]] std::size_t parts_removed() const noexcept { return parts_removed_; }
  [[nodiscard]] std::size_t voids_removed() const noexcept { return voids_removed_; }
  /// Vertices and triangles of all parts that are kept.
  [[nodiscard]] std::size_t vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::size_t triangles() const noexcept { return triangles_; }

 private:
  void choose_rock(const std::vector<PartNumber>& roots, Parts wanted);
  void drop_surrounded(const std::vector<PartNumber>& outers, std::vector<PartNumber> inners,
                       const std::function<void(const Visit&)>& for_each_triangle);

  std::vector<Part> parts_;
  UnionFind sets_{0};
  std::size_t parts_removed_ = 0, voids_removed_ = 0, vertices_ = 0, triangles_ = 0;
};

}  // namespace outcrop::meshing

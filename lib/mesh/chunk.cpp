#include "chunk.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>

#include "outcrop/core/error.h"
#include "outcrop/mesh/marching_cubes.h"

namespace outcrop::meshing {
namespace {

/// The case table with edges as offsets into a brick's slots: axis · 729 + node of the edge's start.
struct SlotTriangle {
  std::array<std::uint16_t, 3> slot;
};
struct SlotCases {
  std::vector<SlotTriangle> triangles;
  std::array<std::uint16_t, 257> first{};
  std::array<std::vector<std::uint32_t>, 256> loop;  ///< Slots around the triangles, where one polygon bounds them.

  SlotCases() {
    for (int c = 0; c < 256; ++c) {
      first[c] = static_cast<std::uint16_t>(triangles.size());
      for (const CellTriangle& t : CaseTable::cube()[c]) {
        SlotTriangle& slots = triangles.emplace_back();
        for (int i = 0; i < 3; ++i) {
          const CubeEdge e = cube_edge(t[i]);
          slots.slot[i] = static_cast<std::uint16_t>(e.axis * kNodes + e.from.x + 9 * e.from.y + 81 * e.from.z);
        }
      }
    }
    first[256] = static_cast<std::uint16_t>(triangles.size());
    for (int c = 0; c < 256; ++c) {
      std::vector<Triangle> slots;
      for (int i = first[c]; i < first[c + 1]; ++i)
        slots.push_back({triangles[i].slot[0], triangles[i].slot[1], triangles[i].slot[2]});
      loop[c] = boundary_loop(slots);
    }
  }
};

constexpr int kFullTurn = 4;

/// In place of a triangle that a fan replaced.
constexpr Triangle kReplaced{0, 0, 0};

/// Numbers the edges of the pieces of one coned cell, 0, 1, ..., as they come.
class CellEdges {
 public:
  /// @param half  The cell's first half node.
  void start(int half) {
    for (std::size_t i = 0; i < size_; ++i) number_[slot(edges_[i])] = 0;
    size_ = 0;
    half_ = half;
  }
  [[nodiscard]] std::uint32_t number(const HalfEdge& edge) {
    std::uint8_t& number = number_[slot(edge)];
    if (number == 0) {
      edges_[size_] = edge;
      number = static_cast<std::uint8_t>(++size_);
    }
    return number - 1u;
  }
  [[nodiscard]] const HalfEdge& edge(std::uint32_t number) const { return edges_[number]; }

 private:
  /// The cell's half nodes are 0 to 2 an axis: 27, and their numbers.
  static constexpr int kLast = half_number(IVec3(2));
  static constexpr auto kLocal = [] {
    std::array<std::uint8_t, kLast + 1> local{};
    for (int i = 0; i < 27; ++i) local[half_number(IVec3(i % 3, i / 3 % 3, i / 9))] = static_cast<std::uint8_t>(i);
    return local;
  }();
  [[nodiscard]] int slot(const HalfEdge& edge) const {
    return kLocal[edge[0] - half_] * 27 + kLocal[edge[1] - half_];
  }

  int half_ = 0;
  std::size_t size_ = 0;
  std::array<HalfEdge, 80> edges_;  ///< Half nodes on the cell's faces are joined by 48 edges, and to its centre by 26.
  std::array<std::uint8_t, 27 * 27> number_{};
};

/// Twice the middle's coordinates and the direction: no two edges of a mesh share both, whatever their lengths.
constexpr int kKeyBits = 19, kDirectionBits = 5;

std::uint64_t direction_of(const IVec3& along) {
  const auto sign = [](int d) { return d > 0 ? 2 : d < 0 ? 0 : 1; };
  return static_cast<std::uint64_t>(sign(along.x) + 3 * sign(along.y) + 9 * sign(along.z));
}

std::uint64_t edge_key(const IVec3& from, const IVec3& along, std::uint64_t direction) {
  const IVec3 middle = 2 * from + along;
  const auto part = [](int coordinate) { return static_cast<std::uint64_t>(coordinate); };
  return ((part(middle.z) << kKeyBits | part(middle.y)) << kKeyBits | part(middle.x)) << kDirectionBits | direction;
}

IVec3 twice_middle(std::uint64_t key) {
  key >>= kDirectionBits;
  IVec3 middle;
  for (int axis = 0; axis < 3; ++axis, key >>= kKeyBits) middle[axis] = static_cast<int>(key & ((1u << kKeyBits) - 1));
  return middle;
}

}  // namespace

int quarters_around(const Lattice& lattice, std::uint64_t key) noexcept {
  const IVec3 middle = twice_middle(key);
  int quarters = kFullTurn;
  for (int axis = 0; axis < 3; ++axis)
    if (middle[axis] == 0 || middle[axis] == 2 * lattice.cells[axis]) quarters /= 2;
  return quarters;
}

Vec3 edge_middle(const Lattice& lattice, std::uint64_t key) noexcept {
  return lattice.place(0.5 * Vec3(twice_middle(key)));
}

void contradiction(const Vec3& where) {
  char place[96];
  std::snprintf(place, sizeof place, "(%.9g, %.9g, %.9g)", where.x, where.y, where.z);
  throw ParameterError(
      std::string("field: expected bound and narrow that agree with its values, got boxes that disagree near ") +
      place);
}

void Chunk::clear() {
  positions.clear();
  normals.clear();
  labels.clear();
  triangles.clear();
  border.clear();
  cells = evaluations = 0;
  bricks.fill(0);
}

Chunk ChunkBuilder::build(const Cell& cell, int level) {
  chunk_.clear();
  shared_.clear();
  shared_number_.clear();
  creases_.clear();
  if (tree_)
    descend(cell, level, {});
  else
    descend_uniformly(cell.index, level, cell.field->narrow(lattice_.box(cell.index, level)));
  join_creases(lattice_, creases_, chunk_.positions, chunk_.normals, chunk_.triangles);
  close_border();
  fill_missing_normals();
  if (!options_.normals) chunk_.normals.clear();
  return chunk_;
}

void ChunkBuilder::descend_uniformly(const IVec3& index, int level, const FieldPtr& narrowed) {
  if (level == 0) return visit({index, level}, *narrowed, nullptr, {});
  for (int octant = 0; octant < 8; ++octant) {
    const IVec3 child = child_index(index, octant);
    if (!lattice_.holds(child, level - 1)) continue;
    const FieldPtr field = narrowed->narrow_to_surface(lattice_.box(child, level - 1));
    if (field) descend_uniformly(child, level - 1, field);
  }
}

void ChunkBuilder::descend(const Cell& cell, int level, std::span<const double> parent) {
  const BrickPlace place{cell.index, level};
  const KnownCell* known = known_->find(BrickTree::key(place));
  const Box box = lattice_.box(cell.index, level);
  if (tree_->is_split(place)) {
    const FieldPtr field = known ? known->field : cell.field->narrow(box);
    const std::span<const double> values = known ? std::span(known->values) : std::span<const double>();
    for (int octant = 0; octant < 8; ++octant) descend({child_index(cell.index, octant), field}, level - 1, values);
  } else if (tree_->is_leaf(place)) {
    // What balance made is not known to hold surface.
    const FieldPtr field = known ? known->field : cell.field->narrow_to_surface(box);
    if (field) visit(place, *field, known, parent);
  }
}

void ChunkBuilder::visit(const BrickPlace& place, const Field& field, const KnownCell* known,
                         std::span<const double> parent) {
  task_.check();
  const auto& [index, level] = place;
  Brick brick(lattice_, index, level);
  bool mixed = false, transition = false;
  if (known && !known->values.empty()) {
    mixed = values_.use(known->values, brick);
  } else {
    mixed = values_.sample(lattice_, field, brick, parent);
    chunk_.evaluations += values_.evaluations();
  }
  if (tree_ && level > 0) {
    const FinerCells finer = tree_->finer_around(place);
    transition = finer.any();
    if (transition) {
      mixed |= transition_.sample(lattice_, field, brick, values_, finer);
      chunk_.evaluations += transition_.evaluations();
    }
  }
  if (mixed) mesh(brick, field, transition);
}

void ChunkBuilder::mesh(const Brick& brick, const Field& field, bool transition) {
  ++chunk_.bricks[brick.level];
  solver_.clear();
  fans_.clear();
  fan_source_.clear();
  const std::size_t first = chunk_.triangles.size();
  find_vertices(brick, transition);
  if (transition) gather_coned(brick);
  emit_cells(brick, transition);
  place(field);
  if (fans_.size() == 0) return;
  emit_fans(brick, field);
  if (!options_.crisp || brick.level > 0) return;
  const auto begin = chunk_.triangles.begin() + static_cast<std::ptrdiff_t>(first);
  const auto is_replaced = [](const Triangle& t) { return t[0] == t[1]; };
  chunk_.triangles.erase(std::remove_if(begin, chunk_.triangles.end(), is_replaced), chunk_.triangles.end());
}

void ChunkBuilder::find_vertices(const Brick& brick, bool transition) {
  const IVec3 first = brick.first(), n = brick.cells;
  const int edge = 1 << brick.level;
  for (int axis = 0; axis < 3; ++axis) {
    const IVec3 along = edge * IVec3(axis == 0, axis == 1, axis == 2);
    const std::uint64_t direction = direction_of(along);
    brick.crossings(axis).for_each([&](int node) {
      const IVec3 p = node_place(node);
      if (transition && (transition_.divided(axis, p.y, p.z) >> p.x & 1)) return;
      const IVec3 from = first + edge * p;
      const double a = values_.at(node), b = values_.at(node + kStride[axis]);
      const int planes = (axis != 0 && (p.x == 0 || p.x == n.x)) + (axis != 1 && (p.y == 0 || p.y == n.y)) +
                         (axis != 2 && (p.z == 0 || p.z == n.z));
      vertex_[axis * kNodes + node] = planes == 0
                                          ? vertex_on(from, along, a, b)
                                          : shared_vertex_on(from, along, a, b, edge_key(from, along, direction), planes);
    });
  }
}

std::uint32_t ChunkBuilder::vertex_on(const IVec3& from, const IVec3& along, double f_a, double f_b) {
  const auto vertex = static_cast<std::uint32_t>(chunk_.positions.size() + solver_.size());
  solver_.add(from, along, f_a, f_b);
  return vertex;
}

std::uint32_t ChunkBuilder::shared_vertex_on(const IVec3& from, const IVec3& along, double f_a, double f_b,
                                             std::uint64_t key, int planes) {
  std::uint32_t& number = shared_number_[key];
  if (number == 0) {
    shared_.push_back({.key = key, .vertex = vertex_on(from, along, f_a, f_b)});
    number = static_cast<std::uint32_t>(shared_.size());
  }
  BorderVertex& shared = shared_[number - 1];
  shared.quarters += planes == 1 ? 2 : 1;
  // Nobody will ask for it again: the table stays as small as the front between bricks, and in the cache.
  if (shared.quarters == kFullTurn) shared_number_.erase(key);
  return shared.vertex;
}

void ChunkBuilder::emit_cells(const Brick& brick, bool transition) {
  static const SlotCases cases;
  const bool crisp = options_.crisp && brick.level == 0;
  std::array<std::uint32_t, kCubeEdges> loop;
  Triangle* end = brick_triangles_.data();
  brick.for_each_mixed_cell([&](int node, int cube_case) {
    if (transition && transition_.is_coned(node)) return;
    ++chunk_.cells;
    const std::uint32_t* const vertex = &vertex_[node];
    Triangle* const begin = end;
    for (int i = cases.first[cube_case]; i < cases.first[cube_case + 1]; ++i) {
      const auto& slot = cases.triangles[i].slot;
      *end++ = {vertex[slot[0]], vertex[slot[1]], vertex[slot[2]]};
    }
    const auto& slots = cases.loop[cube_case];
    if (!crisp || slots.empty()) return;
    std::transform(slots.begin(), slots.end(), loop.begin(), [&](std::uint32_t slot) { return vertex[slot]; });
    fans_.add(brick.first() + IVec3(node % 9, node / 9 % 9, node / 81), 1, std::span(loop).first(slots.size()),
              {begin, end}, options_.tolerance);
    fan_source_.push_back(chunk_.triangles.size() + static_cast<std::size_t>(begin - brick_triangles_.data()));
  });
  chunk_.triangles.insert(chunk_.triangles.end(), brick_triangles_.data(), end);
}

void ChunkBuilder::gather_coned(const Brick& brick) {
  half_vertices_.clear();
  const int edge = 1 << brick.level;
  CellEdges edges;
  for (std::size_t cell = 0; cell < transition_.size(); ++cell) {
    ++chunk_.cells;
    const IVec3& place = transition_.place(cell);
    coned_triangles_.clear();
    edges.start(half_number(2 * place));
    transition_.for_each_triangle(cell, [&](const HalfEdge& a, const HalfEdge& b, const HalfEdge& c) {
      const std::uint32_t u = edges.number(a), v = edges.number(b), w = edges.number(c);
      coned_triangles_.push_back({u, v, w});
    });
    std::vector<std::uint32_t> loop = boundary_loop(coned_triangles_);
    if (loop.empty()) {
      emit_coned(brick, cell);
      continue;
    }
    for (std::uint32_t& v : loop) v = half_vertex(brick, edges.edge(v));
    fans_.add(brick.first() + edge * place, edge, loop, {}, options_.tolerance);
    fan_source_.push_back(cell);
  }
}

void ChunkBuilder::emit_coned(const Brick& brick, std::size_t cell) {
  transition_.for_each_triangle(cell, [&](const HalfEdge& a, const HalfEdge& b, const HalfEdge& c) {
    const std::uint32_t u = half_vertex(brick, a), v = half_vertex(brick, b), w = half_vertex(brick, c);
    chunk_.triangles.push_back({u, v, w});
  });
}

void ChunkBuilder::emit_fans(const Brick& brick, const Field& field) {
  chunk_.evaluations += fans_.solve(lattice_, field, chunk_.positions, chunk_.normals);
  solver_.clear();
  std::vector<double> x, y, z;
  for (std::size_t i = 0; i < fans_.size(); ++i) {
    const CellFans::Fan& fan = fans_.fan(i);
    const std::size_t replaced = fans_.replaced(i);
    if (!fan.taken) continue;
    const auto apex = static_cast<std::uint32_t>(chunk_.positions.size());
    chunk_.positions.push_back(fan.position);
    chunk_.normals.push_back(fan.crease ? Vec3f(0.0f) : Vec3f(glm::normalize(fan.gradient)));
    for (std::size_t t = 0; t < replaced; ++t) chunk_.triangles[fan_source_[i] + t] = kReplaced;
    const auto loop = fans_.loop(i);
    for (std::size_t v = 0; v < loop.size(); ++v)
      chunk_.triangles.push_back({loop[v], loop[(v + 1) % loop.size()], apex});
    if (fan.crease && brick.level == 0) creases_.push_back({apex, fans_.first(i), fan.up});
    const Vec3 p = lattice_.origin + Vec3(fan.position);
    x.push_back(p.x);
    y.push_back(p.y);
    z.push_back(p.z);
  }
  if (options_.labels) {
    const std::size_t start = chunk_.labels.size();
    chunk_.labels.resize(start + x.size());
    field.labels({x, y, z}, std::span(chunk_.labels).subspan(start));
  }
  for (std::size_t i = 0; i < fans_.size(); ++i)
    if (!fans_.fan(i).taken && fans_.replaced(i) == 0) emit_coned(brick, fan_source_[i]);
  if (solver_.size() > 0) place(field);
}

std::uint32_t ChunkBuilder::half_vertex(const Brick& brick, const HalfEdge& edge) {
  const IVec3 a = half_place(edge[0]), b = half_place(edge[1]);
  const IVec3 d = b - a;
  if (d.x + d.y + d.z == 2 && (d.x == 2 || d.y == 2 || d.z == 2)) {  // An edge of the cell.
    const int axis = d.x == 2 ? 0 : d.y == 2 ? 1 : 2;
    return vertex_[axis * kNodes + a.x / 2 + 9 * (a.y / 2) + 81 * (a.z / 2)];
  }
  std::uint32_t& vertex =
      half_vertices_[static_cast<std::uint64_t>(edge[0]) << 16 | static_cast<std::uint64_t>(edge[1])];
  if (vertex != 0) return vertex - 1;
  int planes = 0;
  for (int axis = 0; axis < 3; ++axis)
    planes += a[axis] == b[axis] && (a[axis] == 0 || a[axis] == 2 * brick.cells[axis]);
  const int half = (1 << brick.level) / 2;
  const IVec3 from = brick.first() + half * a, along = half * d;
  const double f_a = transition_.at(edge[0]), f_b = transition_.at(edge[1]);
  const std::uint32_t made =
      planes == 0 ? vertex_on(from, along, f_a, f_b)
                  : shared_vertex_on(from, along, f_a, f_b, edge_key(from, along, direction_of(along)), planes);
  vertex = made + 1;
  return made;
}

void ChunkBuilder::place(const Field& field) {
  const std::size_t n = solver_.size(), start = chunk_.positions.size();
  chunk_.evaluations += solver_.solve(lattice_, field, options_.normals || options_.crisp || tree_);
  for (std::size_t i = 0; i < n; ++i) chunk_.positions.push_back(solver_.local(i));
  for (const Vec3& g : solver_.gradients()) {
    const double length = glm::length(g);
    // No gradient, no normal: left zero here and taken from the triangles later.
    chunk_.normals.push_back(length > 0.0 && std::isfinite(length) ? Vec3f(g * (1.0 / length)) : Vec3f(0.0f));
  }
  if (options_.labels) {
    chunk_.labels.resize(start + n);
    field.labels(solver_.places(), std::span(chunk_.labels).subspan(start));
  }
}

void ChunkBuilder::close_border() {
  std::copy_if(shared_.begin(), shared_.end(), std::back_inserter(chunk_.border), [&](const BorderVertex& shared) {
    return shared.quarters != quarters_around(lattice_, shared.key);
  });
}

void ChunkBuilder::fill_missing_normals() {
  const auto& normals = chunk_.normals;
  if (std::find(normals.begin(), normals.end(), Vec3f(0.0f)) == normals.end()) return;
  // The mean direction of the vertex's triangles in this chunk, weighted by area.
  const auto is_missing = [&](std::uint32_t v) { return normals[v] == Vec3f(0.0f); };
  FlatMap<Vec3> sums;  // By vertex and 1.
  for (const Triangle& t : chunk_.triangles) {
    if (!std::any_of(t.begin(), t.end(), is_missing)) continue;
    const Vec3 a(chunk_.positions[t[0]]), b(chunk_.positions[t[1]]), c(chunk_.positions[t[2]]);
    for (const std::uint32_t v : t)
      if (is_missing(v)) sums[v + std::uint64_t{1}] += glm::cross(b - a, c - a);
  }
  for (std::uint32_t v = 0; v < normals.size(); ++v) {
    if (!is_missing(v)) continue;
    const Vec3* const sum = sums.find(v + std::uint64_t{1});
    const double length = sum ? glm::length(*sum) : 0.0;
    chunk_.normals[v] = length > 0.0 ? Vec3f(*sum / length) : Vec3f(0, 0, 1);
  }
}

}  // namespace outcrop::meshing

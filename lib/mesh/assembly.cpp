#include "assembly.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

#include "outcrop/core/error.h"

namespace outcrop::meshing {

ChunkSummary summarise(const Chunk& chunk, const Lattice& lattice, const AssemblyNeeds& needs) {
  ChunkSummary summary;
  std::vector<std::uint32_t> part_of;
  if (needs.parts) {
    ChunkParts found = find_parts(chunk, lattice);
    summary.parts = std::move(found.parts);
    part_of = std::move(found.part_of);
  } else if (!chunk.positions.empty()) {
    summary.parts = {{.volume = 1.0, .vertices = chunk.positions.size(), .triangles = chunk.triangles.size()}};
    part_of.resize(chunk.positions.size(), 0);
  }
  for (const BorderVertex& b : chunk.border) summary.border_part.push_back(part_of[b.vertex]);
  if (!chunk.labels.empty()) summary.largest_label = *std::max_element(chunk.labels.begin(), chunk.labels.end());
  if (!needs.walls) return summary;

  // No diagonal of a cell lies in a face of it: a triangle's edge that lies in a side of the lattice ends the sheet.
  std::vector<unsigned> sides(chunk.positions.size());
  std::vector<std::uint32_t> number(chunk.positions.size());
  for (std::uint32_t v = 0; v < chunk.positions.size(); ++v) {
    sides[v] = sides_of(lattice, chunk.positions[v]);
    if (sides[v] == 0) continue;
    number[v] = static_cast<std::uint32_t>(summary.sides.size());
    summary.sides.push_back({v, part_of[v], chunk.positions[v]});
  }
  if (summary.sides.empty()) return summary;
  for (const Triangle& t : chunk.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      const unsigned shared = sides[a] & sides[b];
      if (shared != 0) summary.segments[std::countr_zero(shared)].emplace_back(number[a], number[b]);
    }
  return summary;
}

Assembly::Joint& Assembly::joint(const BorderVertex& border, bool& first) {
  Joint& joint = joints_[border.key];
  first = joint.quarters == 0;
  joint.quarters += border.quarters;
  return joint;
}

void Assembly::release(const BorderVertex& border) {
  const Joint* joint = joints_.find(border.key);
  if (joint->quarters == quarters_around(lattice_, border.key)) joints_.erase(border.key);
}

void Assembly::add(Chunk chunk, ChunkSummary summary) {
  ChunkRecord record;
  record.parts = static_cast<std::uint32_t>(summary.parts.size());
  record.first_part = parts_.add(std::move(summary.parts));
  totals_.largest_label = std::max(totals_.largest_label, summary.largest_label);

  std::size_t next_side = 0;
  for (std::size_t i = 0; i < chunk.border.size(); ++i) {
    const PartList::PartNumber part = record.first_part + summary.border_part[i];
    bool first = false;
    Joint& known = joint(chunk.border[i], first);
    if (first) {
      known.number = part;
    } else {
      parts_.join(part, known.number);
      --parts_.part(part).vertices;  // Counted where the edge came first.
    }
    // Both lists follow the chunk's vertices; those on a side get a number, once.
    while (next_side < summary.sides.size() && summary.sides[next_side].vertex < chunk.border[i].vertex) {
      record.sides.emplace_back(summary.sides[next_side].vertex, static_cast<std::uint32_t>(curves_.vertices.size()));
      curves_.vertices.push_back(summary.sides[next_side].position);
      side_part_.push_back(record.first_part + summary.sides[next_side++].part);
    }
    if (next_side < summary.sides.size() && summary.sides[next_side].vertex == chunk.border[i].vertex) {
      if (known.side == kNone) {
        known.side = static_cast<std::uint32_t>(curves_.vertices.size());
        curves_.vertices.push_back(summary.sides[next_side].position);
        side_part_.push_back(part);
      }
      record.sides.emplace_back(summary.sides[next_side++].vertex, known.side);
    }
    release(chunk.border[i]);
  }
  for (; next_side < summary.sides.size(); ++next_side) {
    record.sides.emplace_back(summary.sides[next_side].vertex, static_cast<std::uint32_t>(curves_.vertices.size()));
    curves_.vertices.push_back(summary.sides[next_side].position);
    side_part_.push_back(record.first_part + summary.sides[next_side].part);
  }
  for (int side = 0; side < 6; ++side)
    for (const auto& [a, b] : summary.segments[side])
      curves_.segments[side].emplace_back(record.sides[a].second, record.sides[b].second);

  statistics_.cells += chunk.cells;
  statistics_.evaluations += chunk.evaluations;
  for (std::size_t level = 0; level < chunk.bricks.size(); ++level) statistics_.bricks[level] += chunk.bricks[level];
  chunks_.push_back(std::move(record));
  store_->add(std::move(chunk));
}

void Assembly::add_walls(const Field& field, const Task& task) {
  walls_ = make_walls(curves_, field, lattice_, options_, task);
  std::vector<Part> corners;
  for (const Vec3f& p : walls_.corners) {
    Part& part = corners.emplace_back(Part{.origin = Vec3(p), .vertices = 1});
    part.box.include(Vec3(p));
    part.grounded = (sides_of(lattice_, p) & kFloorSide) != 0;
  }
  first_corner_part_ = parts_.add(std::move(corners));
  const bool kept = options_.border == Border::Closed;
  const auto vertices = static_cast<std::uint32_t>(curves_.vertices.size());
  const auto part = [&](std::uint32_t v) {
    return v < vertices ? side_part_[v] : first_corner_part_ + (v - vertices);
  };
  const auto position = [&](std::uint32_t v) -> const Vec3f& {
    return v < vertices ? curves_.vertices[v] : walls_.corners[v - vertices];
  };
  for (const Triangle& t : walls_.triangles) {
    Part& first = parts_.part(part(t[0]));
    first.add_triangle(position(t[0]), position(t[1]), position(t[2]));
    first.triangles += kept;
    parts_.join(part(t[0]), part(t[1]));
    parts_.join(part(t[0]), part(t[2]));
  }
  if (!kept)
    for (PartList::PartNumber i = 0; i < walls_.corners.size(); ++i) parts_.part(first_corner_part_ + i).vertices = 0;
}

void Assembly::for_each_triangle(const PartList::Visit& visit) {
  for (std::size_t i = 0; i < chunks_.size(); ++i) {
    const Chunk chunk = store_->get(i, false);
    const ChunkParts parts = find_parts(chunk, lattice_);
    for (const Triangle& t : chunk.triangles)
      visit(chunks_[i].first_part + parts.part_of[t[0]], chunk.positions[t[0]], chunk.positions[t[1]],
            chunk.positions[t[2]]);
  }
  const auto vertices = static_cast<std::uint32_t>(curves_.vertices.size());
  const auto position = [&](std::uint32_t v) -> const Vec3f& {
    return v < vertices ? curves_.vertices[v] : walls_.corners[v - vertices];
  };
  for (const Triangle& t : walls_.triangles)
    visit(t[0] < vertices ? side_part_[t[0]] : first_corner_part_ + (t[0] - vertices), position(t[0]), position(t[1]),
          position(t[2]));
}

void Assembly::finish(const Field& field, const Task& task) {
  joints_.for_each([&](std::uint64_t key, const Joint&) { contradiction(edge_middle(lattice_, key)); });
  if (needs_.walls) add_walls(field, task);
  const auto all = [&](const PartList::Visit& visit) { for_each_triangle(visit); };
  parts_.choose(needs_.parts ? options_.parts : Parts::All, options_.keep_voids, all);
  statistics_.parts_removed = parts_.parts_removed();
  statistics_.voids_removed = parts_.voids_removed();
  statistics_.resolution = options_.resolution;
  statistics_.tolerance = options_.tolerance;
  statistics_.extent = {lattice_.lo, lattice_.node(lattice_.cells)};
  totals_.origin = lattice_.origin;
  totals_.vertices = parts_.vertices();
  totals_.triangles = parts_.triangles();
  totals_.normals = options_.normals;
  totals_.labels = options_.labels;
  require(totals_.vertices < std::numeric_limits<std::uint32_t>::max(), "resolution", "at most 2^32 vertices; coarser",
          options_.resolution);
}

void Assembly::emit_chunk(std::size_t index, std::span<MeshSink* const> sinks) {
  const ChunkRecord& record = chunks_[index];
  Chunk chunk = store_->get(index, true);
  std::vector<std::uint32_t> kept_part(record.parts);
  bool all = true;
  for (std::uint32_t p = 0; p < record.parts; ++p) {
    kept_part[p] = parts_.keeps(record.first_part + p);
    all = all && kept_part[p];
  }
  std::vector<std::uint32_t> part_of;
  if (!all) part_of = find_parts(chunk, lattice_).part_of;

  // The mesh's numbers of the vertices that stay; those are moved together.
  std::vector<std::uint32_t> numbers(chunk.positions.size()), moved(chunk.positions.size(), kNone);
  const std::uint32_t first_number = next_number_;
  std::size_t border = 0;
  std::uint32_t kept = 0;
  for (std::uint32_t v = 0; v < chunk.positions.size(); ++v) {
    const bool on_border = border < chunk.border.size() && chunk.border[border].vertex == v;
    const bool keep = all || kept_part[part_of[v]];
    std::uint32_t number = next_number_;
    if (on_border) {
      const BorderVertex& b = chunk.border[border++];
      bool first = false;
      Joint& known = joint(b, first);
      if (first) known.number = next_number_;
      number = known.number;
      release(b);
    }
    if (!keep) continue;
    if (number == next_number_) ++next_number_;
    moved[v] = kept;
    numbers[kept] = number;
    chunk.positions[kept] = chunk.positions[v];
    if (options_.normals) chunk.normals[kept] = chunk.normals[v];
    if (options_.labels) chunk.labels[kept] = chunk.labels[v];
    ++kept;
  }
  for (const auto& [vertex, side] : record.sides)
    if (moved[vertex] != kNone) side_number_[side] = numbers[moved[vertex]];
  if (!all) {
    std::size_t triangles = 0;
    for (const Triangle& t : chunk.triangles)
      if (moved[t[0]] != kNone) chunk.triangles[triangles++] = {moved[t[0]], moved[t[1]], moved[t[2]]};
    chunk.triangles.resize(triangles);
  }
  if (chunk.triangles.empty()) return;
  const auto some = [&](const auto& array) { return std::span(array).first(array.empty() ? 0 : kept); };
  const MeshPiece piece{some(chunk.positions), some(chunk.normals), some(chunk.labels), some(numbers),
                        first_number,          chunk.triangles};
  for (MeshSink* sink : sinks) sink->add(piece);
}

void Assembly::emit_walls(std::span<MeshSink* const> sinks) const {
  // Kept triangles with the vertices that they use; corners are new to the mesh.
  const auto vertices = static_cast<std::uint32_t>(curves_.vertices.size());
  std::vector<std::uint32_t> moved(vertices + walls_.corners.size(), kNone), numbers;
  std::vector<Vec3f> positions, normals;
  std::vector<Label> labels;
  std::vector<Triangle> triangles;
  std::uint32_t next = next_number_;
  for (std::uint32_t v = 0; v < moved.size(); ++v) {
    if (side_number_[v] == kNone) continue;
    moved[v] = static_cast<std::uint32_t>(positions.size());
    const bool corner = v >= vertices;
    positions.push_back(corner ? walls_.corners[v - vertices] : curves_.vertices[v]);
    if (options_.normals) normals.push_back(corner ? walls_.normals[v - vertices] : Vec3f(0.0f));
    if (options_.labels) labels.push_back(corner ? walls_.labels[v - vertices] : Label{0});
    numbers.push_back(corner ? next++ : side_number_[v]);
  }
  for (const Triangle& t : walls_.triangles)
    if (moved[t[0]] != kNone) triangles.push_back({moved[t[0]], moved[t[1]], moved[t[2]]});
  if (triangles.empty()) return;
  const MeshPiece piece{positions, normals, labels, numbers, next_number_, triangles};
  for (MeshSink* sink : sinks) sink->add(piece);
}

void Assembly::emit(std::span<MeshSink* const> sinks, const Task& task) {
  for (MeshSink* sink : sinks) sink->begin(totals_);
  joints_.clear();
  side_number_.assign(curves_.vertices.size() + walls_.corners.size(), kNone);
  for (std::size_t i = 0; i < chunks_.size(); ++i) {
    task.check();
    emit_chunk(i, sinks);
  }
  if (options_.border == Border::Closed) {
    for (std::uint32_t c = 0; c < walls_.corners.size(); ++c)
      if (parts_.keeps(first_corner_part_ + c)) side_number_[curves_.vertices.size() + c] = 0;
    emit_walls(sinks);
  }
  for (MeshSink* sink : sinks) sink->end();
}

}  // namespace outcrop::meshing

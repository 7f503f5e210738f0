#include "refine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "outcrop/core/simd.h"
#include "outcrop/mesh/marching_cubes.h"

namespace outcrop::meshing {
namespace {

/// A side of a triangle is cut into up to this many parts to look for what lies off it.
constexpr int kMostSubdivisions = 4;
/// Below this share of the steepest slope that values along the lattice show, a cell's slope says nothing.
constexpr double kLeastSlope = 0.1;
/// With half the cells the error goes down to a half where there is a crease, to a quarter where the surface is smooth.
/// Where it is this many tolerances, half the cells cannot do.
constexpr double kCertain = 6.0;
/// One cell in so many is enough to tell most bricks that are to be split.
constexpr std::size_t kFirstLook = 8;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// The octant of its brick in which a cell lies.
std::size_t octant_of(int node) {
  const IVec3 half = node_place(node) / (kBrickCells / 2);
  return static_cast<std::size_t>(half.x + 2 * half.y + 4 * half.z);
}

/// flags[n] = 1 where values n and n + step have one sign, and what is on either side of them leads past 0 within a
/// step. Where the line or the brick ends there may be flags that mean nothing.
OUTCROP_SIMD_CLONES
void mark_leading(const double* __restrict values, int step, std::uint8_t* __restrict flags) {
  const auto leads = [](double from, double to) { return std::abs(to - from) > std::abs(to); };
  const auto same = [](double a, double b) { return (a < 0.0) == (b < 0.0); };
  for (int n = 0; n < step; ++n)
    flags[n] = same(values[n], values[n + step]) & leads(values[n + 2 * step], values[n + step]);
  for (int n = step; n < kNodes - 2 * step; ++n)
    flags[n] = same(values[n], values[n + step]) &
               (leads(values[n - step], values[n]) | leads(values[n + 2 * step], values[n + step]));
  for (int n = kNodes - 2 * step; n < kNodes - step; ++n)
    flags[n] = same(values[n], values[n + step]) & leads(values[n - step], values[n]);
}

}  // namespace

void BrickError::start() {
  for (std::vector<double>* values : {&x_, &y_, &z_, &slopes_}) values->clear();
}

double BrickError::hidden(double enough, const Lattice& lattice, const Field& field, const Brick& brick,
                          const BrickValues& values) {
  start();
  const Vec3 first(brick.first());
  const double stride = 1 << brick.level;
  const IVec3 n = brick.cells;
  for (int axis = 0; axis < 3; ++axis) {
    const int step = kStride[axis];
    const double edge = lattice.step[axis] * stride;
    std::array<std::uint8_t, NodeSet::kWords * 64> leading{};
    mark_leading(values.all().data(), step, leading.data());
    (NodeSet::of(leading.data()) & brick.shape.edges[axis]).for_each([&](int node) {
      const IVec3 place = node_place(node);
      const int along = place[axis];
      const double b = values.at(node), c = values.at(node + step);
      // Straight on from both sides, the values meet where a crease between the nodes would be.
      const double left = along > 0 ? b - values.at(node - step) : 0.0;
      const double right = along + 2 <= n[axis] ? values.at(node + 2 * step) - c : 0.0;
      const double towards = b < 0.0 ? 1.0 : -1.0;  // The way to 0.
      if (towards * left <= 0.0 && towards * right >= 0.0) return;
      double t = 0.5;
      if (along > 0 && along + 2 <= n[axis] && std::abs(left - right) > 0.0)
        t = std::clamp((c - b - right) / (left - right), 0.0, 1.0);
      const double peak = std::max(towards * (b + t * left), towards * (c - (1.0 - t) * right));
      const double slope = std::max(std::abs(left), std::abs(right)) / edge;
      if (peak <= (enough < kUnlimited ? enough * slope : 0.0)) return;
      Vec3 at(place);
      at[axis] += t;
      const Vec3 p = lattice.place(first + stride * at);
      x_.push_back(p.x);
      y_.push_back(p.y);
      z_.push_back(p.z);
      slopes_.push_back(towards * slope);
    });
  }
  f_.resize(x_.size());
  field.values({x_, y_, z_}, f_, {});
  evaluations_ += f_.size();
  double most = 0.0;
  for (std::size_t i = 0; i < f_.size(); ++i) most = std::max(most, f_[i] / slopes_[i]);
  return most;
}

void BrickError::reconstruct(const Brick& brick, const BrickValues& values) {
  vertices_.clear();
  triangles_.clear();
  cells_.clear();
  const Vec3 first(brick.first());
  const double stride = 1 << brick.level;
  for (int axis = 0; axis < 3; ++axis)
    brick.crossings(axis).for_each([&](int node) {
      const double a = values.at(node), b = values.at(node + kStride[axis]);
      Vec3 at(node_place(node));
      at[axis] += a / (a - b);
      vertex_of_edge_[axis * kNodes + node] = static_cast<int>(vertices_.size());
      vertices_.push_back({first + stride * at});
    });
  const CaseTable& cases = CaseTable::cube();
  brick.for_each_mixed_cell([&](int node, int cube_case) {
    MixedCell& cell = cells_.emplace_back(MixedCell{node, static_cast<int>(triangles_.size()), 0});
    for (const CellTriangle& t : cases[cube_case]) {
      std::array<int, 3>& triangle = triangles_.emplace_back();
      for (int corner = 0; corner < 3; ++corner) {
        const CubeEdge e = cube_edge(t[corner]);
        triangle[corner] = vertex_of_edge_[e.axis * kNodes + node + e.from.x + 9 * e.from.y + 81 * e.from.z];
      }
    }
    cell.last = static_cast<int>(triangles_.size());
  });
}

double BrickError::slope(const Vec3& per_metre, const BrickValues& values, int node) {
  Vec3 mean(0.0);
  double steepest = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 8; ++corner) {
      if (corner >> axis & 1) continue;
      const int at = node + (corner & 1) + 9 * (corner >> 1 & 1) + 81 * (corner >> 2);
      const double difference = (values.at(at + kStride[axis]) - values.at(at)) * per_metre[axis];
      mean[axis] += 0.25 * difference;
      steepest = std::max(steepest, std::abs(difference));
    }
  return std::max(glm::length(mean), kLeastSlope * steepest);
}

double BrickError::deviation(const Lattice& lattice, const Field& field, const Brick& brick, const BrickValues& values,
                             std::span<const MixedCell> cells, int subdivisions) {
  if (cells.empty()) return 0.0;
  // The middles of the small triangles that are not turned around.
  std::array<Vec3, kMostSubdivisions * (kMostSubdivisions + 1) / 2> all_weights;
  std::size_t count = 0;
  for (int u = 0; u < subdivisions; ++u)
    for (int v = 0; u + v < subdivisions; ++v) {
      const double a = (u + 1.0 / 3.0) / subdivisions, b = (v + 1.0 / 3.0) / subdivisions;
      all_weights[count++] = {a, b, 1.0 - a - b};
    }
  const std::span<const Vec3> weights = std::span(all_weights).first(count);
  start();
  const auto add = [&](const Vec3& index) {
    const Vec3 p = lattice.place(index);
    x_.push_back(p.x);
    y_.push_back(p.y);
    z_.push_back(p.z);
  };
  const auto for_each_triangle = [&](const MixedCell& cell, const auto& visit) {
    for (int t = cell.first; t < cell.last; ++t)
      visit(vertices_[triangles_[t][0]], vertices_[triangles_[t][1]], vertices_[triangles_[t][2]]);
  };
  // The mesh's vertices will be roots: what its triangles are off by is what is left when these values are subtracted.
  asked_.clear();
  for (const MixedCell& cell : cells)
    for (int t = cell.first; t < cell.last; ++t)
      for (const int v : triangles_[t]) {
        if (vertices_[v].known) continue;
        vertices_[v].known = true;
        asked_.push_back(v);
        add(vertices_[v].index);
      }
  for (const MixedCell& cell : cells)
    for_each_triangle(cell, [&](const Vertex& a, const Vertex& b, const Vertex& c) {
      for (const Vec3& w : weights) add(w.x * a.index + w.y * b.index + w.z * c.index);
    });
  f_.resize(x_.size());
  field.values({x_, y_, z_}, f_, {});
  evaluations_ += f_.size();
  std::size_t i = 0;
  for (const int v : asked_) vertices_[v].value = f_[i++];
  const Vec3 per_metre = 1.0 / (lattice.step * double(1 << brick.level));
  double most = 0.0;
  for (const MixedCell& cell : cells) {
    double off = 0.0;
    for_each_triangle(cell, [&](const Vertex& a, const Vertex& b, const Vertex& c) {
      for (const Vec3& w : weights)
        off = std::max(off, std::abs(f_[i++] - (w.x * a.value + w.y * b.value + w.z * c.value)));
    });
    off /= slope(per_metre, values, cell.node);
    double& octant = octants_[octant_of(cell.node)];
    octant = std::max(octant, off);
    most = std::max(most, off);
  }
  return most;
}

double BrickError::measure(double enough, const Lattice& lattice, const Field& field, const Brick& brick,
                           const BrickValues& values) {
  reconstruct(brick, values);
  octants_.fill(0.0);
  double error = 0.0;
  std::size_t seen = 0;
  const auto look = [&](std::size_t last, int subdivisions) {
    const auto cells = std::span(cells_).subspan(seen, last - seen);
    error = std::max(error, deviation(lattice, field, brick, values, cells, subdivisions));
    return error > enough;
  };
  for (; seen * kFirstLook < cells_.size(); ++seen) std::swap(cells_[seen], cells_[seen * kFirstLook]);
  const std::size_t some = std::exchange(seen, 0);
  if (look(some, 1) && brick.level == 1) return error;
  seen = some;
  if (error > kCertain * enough) {
    // It is to be split, and so are octants that are off by so much: they need no second look.
    cells_.erase(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(std::exchange(seen, 0)));
    std::erase_if(cells_, [&](const MixedCell& cell) { return octants_[octant_of(cell.node)] > kCertain * enough; });
  }
  if (look(cells_.size(), 1)) return error;
  error = std::max(error, hidden(enough, lattice, field, brick, values));
  if (error > enough) return error;
  seen = 0;
  const int subdivisions = std::min(1 << (brick.level - 1), kMostSubdivisions);
  if (subdivisions > 1 && look(cells_.size(), subdivisions)) return error;
  return std::max(error, buried(lattice, field, brick, values));
}

double BrickError::buried(const Lattice& lattice, const Field& field, const Brick& brick, const BrickValues& values) {
  const int probes = std::min((1 << brick.level) / 4, kMostSubdivisions);
  if (probes == 0) return 0.0;
  start();
  const Vec3 first(brick.first());
  const double stride = 1 << brick.level;
  const double reach = clear_value(field, 0.5 * stride * glm::length(lattice.step));
  for (int k = 0; k < brick.cells.z; ++k)
    for (int j = 0; j < brick.cells.y; ++j)
      for (int i = 0; i < brick.cells.x; ++i) {
        double lowest = kUnlimited, highest = -kUnlimited;
        for (int corner = 0; corner < 8; ++corner) {
          const double f = values.at(i + j * 9 + k * 81 + (corner & 1) + 9 * (corner >> 1 & 1) + 81 * (corner >> 2));
          lowest = std::min(lowest, f);
          highest = std::max(highest, f);
        }
        if (lowest > reach || highest < -reach || (lowest < 0.0 && highest >= 0.0)) continue;
        for (int probe = 0; probe < probes * probes * probes; ++probe) {
          const Vec3 part(probe % probes, probe / probes % probes, probe / (probes * probes));
          const Vec3 p = lattice.place(first + stride * (Vec3(i, j, k) + (part + 0.5) / double(probes)));
          x_.push_back(p.x);
          y_.push_back(p.y);
          z_.push_back(p.z);
          slopes_.push_back(lowest < 0.0 ? 1.0 : -1.0);
        }
      }
  f_.resize(x_.size());
  field.values({x_, y_, z_}, f_, {});
  evaluations_ += f_.size();
  double most = 0.0;
  for (std::size_t i = 0; i < f_.size(); ++i) most = std::max(most, f_[i] * slopes_[i]);
  return most;
}

namespace {

class Refiner {
 public:
  Refiner(const Lattice& lattice, double tolerance, const ForcedSplits& forced)
      : lattice_(lattice), tolerance_(tolerance), forced_(forced) {}

  /// @param parent   The values of the brick around the cell, or none.
  /// @param certain  The cell is split without a look.
  void descend(const Cell& cell, int level, std::span<const double> parent = {}, bool certain = false) {
    if (level == 0) {
      result_.leaves.push_back({cell.index, level});
      return;
    }
    KnownCell known{cell.field->narrow(lattice_.box(cell.index, level)), {}};
    unsigned certain_octants = 0;
    if (level <= lattice_.coarsest && !certain) {
      const bool coarse = is_coarse(cell.index, level, *known.field, parent);
      if (!forced_) known.values = values_.all();
      if (!coarse) {
        result_.leaves.push_back({cell.index, level});
        result_.known.emplace_back(BrickPlace{cell.index, level}, std::move(known));
        return;
      }
      for (int octant = 0; octant < 8 && !forced_; ++octant)
        if (error_.octants()[octant] > kCertain * tolerance_) certain_octants |= 1u << octant;
    }
    const FieldPtr field = known.field;
    const std::span<const double> values = known.values;  // They stay in place while the list grows.
    result_.known.emplace_back(BrickPlace{cell.index, level}, std::move(known));
    for (const Cell& child : children(lattice_, cell.index, level, field)) {
      const IVec3 at = child.index - 2 * cell.index;
      descend(child, level - 1, values, !certain && (certain_octants >> (at.x + 2 * at.y + 4 * at.z) & 1) != 0);
    }
  }

  Refinement take() {
    result_.evaluations += error_.evaluations();
    return std::move(result_);
  }

 private:
  bool is_coarse(const IVec3& index, int level, const Field& field, std::span<const double> parent) {
    if (forced_) return forced_({index, level});
    Brick brick(lattice_, index, level);
    values_.sample(lattice_, field, brick, parent);
    result_.evaluations += values_.evaluations();
    return error_.measure(tolerance_, lattice_, field, brick, values_) > tolerance_;
  }

  const Lattice& lattice_;
  double tolerance_;
  const ForcedSplits& forced_;
  BrickValues values_;
  BrickError error_;
  Refinement result_;
};

}  // namespace

Refinement refine(const Lattice& lattice, const Cell& cell, int level, double tolerance, const ForcedSplits& forced) {
  Refiner refiner(lattice, tolerance, forced);
  refiner.descend(cell, level);
  return refiner.take();
}

}  // namespace outcrop::meshing

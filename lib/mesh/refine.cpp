#include "refine.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

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
    for (int k = 0; k <= n.z - (axis == 2); ++k)
      for (int j = 0; j <= n.y - (axis == 1); ++j)
        for (int i = 0; i <= n.x - (axis == 0); ++i) {
          const int node = i + 9 * j + 81 * k, along = axis == 0 ? i : axis == 1 ? j : k;
          const double b = values.at(node), c = values.at(node + step);
          if ((b < 0.0) != (c < 0.0)) continue;
          // Straight on from both sides, the values meet where a crease between the nodes would be.
          const double left = along > 0 ? b - values.at(node - step) : 0.0;
          const double right = along + 2 <= n[axis] ? values.at(node + 2 * step) - c : 0.0;
          const double towards = b < 0.0 ? 1.0 : -1.0;  // The way to 0.
          if (towards * left <= 0.0 && towards * right >= 0.0) continue;
          double t = 0.5;
          if (along > 0 && along + 2 <= n[axis] && std::abs(left - right) > 0.0)
            t = std::clamp((c - b - right) / (left - right), 0.0, 1.0);
          const double peak = std::max(towards * (b + t * left), towards * (c - (1.0 - t) * right));
          const double slope = std::max(std::abs(left), std::abs(right)) / edge;
          if (peak <= (enough < kUnlimited ? enough * slope : 0.0)) continue;
          Vec3 at(i, j, k);
          at[axis] += t;
          const Vec3 p = lattice.place(first + stride * at);
          x_.push_back(p.x);
          y_.push_back(p.y);
          z_.push_back(p.z);
          slopes_.push_back(towards * slope);
        }
  }
  f_.resize(x_.size());
  field.values({x_, y_, z_}, f_, {});
  evaluations_ += f_.size();
  double most = 0.0;
  for (std::size_t i = 0; i < f_.size(); ++i) most = std::max(most, f_[i] / slopes_[i]);
  return most;
}

void BrickError::reconstruct(const Lattice& lattice, const Brick& brick, const BrickValues& values) {
  vertices_.clear();
  faces_.clear();
  const Vec3 first(brick.first());
  const double stride = 1 << brick.level;
  brick.for_each_row([&](int axis, int j, int k, unsigned crossing) {
    for (unsigned bits = crossing & ((1u << (brick.cells.x + (axis != 0))) - 1); bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits), node = i + 9 * j + 81 * k;
      const double a = values.at(node), b = values.at(node + kStride[axis]);
      Vec3 at(i, j, k);
      at[axis] += a / (a - b);
      vertex_of_edge_[axis * kNodes + node] = static_cast<int>(vertices_.size());
      vertices_.push_back({first + stride * at});
    }
  });
  brick.for_each_mixed_cell([&](int node, int cube_case) {
    Vec3 slope(0.0);
    double steepest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const int at = node + (corner & 1) + 9 * (corner >> 1 & 1) + 81 * (corner >> 2);
      for (int axis = 0; axis < 3; ++axis) {
        if (corner >> axis & 1) continue;
        const double difference = (values.at(at + kStride[axis]) - values.at(at)) / (lattice.step[axis] * stride);
        slope[axis] += 0.25 * difference;
        steepest = std::max(steepest, std::abs(difference));
      }
    }
    constexpr int kHalf = kBrickCells / 2;
    const int octant = (node % 9 >= kHalf) + 2 * (node / 9 % 9 >= kHalf) + 4 * (node / 81 >= kHalf);
    const double length = std::max(glm::length(slope), kLeastSlope * steepest);
    for (const CellTriangle& t : CaseTable::cube()[cube_case]) {
      Face& face = faces_.emplace_back();
      face.slope = length;
      face.octant = octant;
      for (int corner = 0; corner < 3; ++corner) {
        const CubeEdge e = cube_edge(t[corner]);
        face.vertex[corner] = vertex_of_edge_[e.axis * kNodes + node + e.from.x + 9 * e.from.y + 81 * e.from.z];
      }
    }
  });
}

double BrickError::deviation(const Lattice& lattice, const Field& field, int subdivisions) {
  octants_.fill(0.0);
  if (faces_.empty()) return 0.0;
  // The middles of the small triangles that are not turned around.
  std::vector<Vec3> weights;
  for (int u = 0; u < subdivisions; ++u)
    for (int v = 0; u + v < subdivisions; ++v) {
      const double a = (u + 1.0 / 3.0) / subdivisions, b = (v + 1.0 / 3.0) / subdivisions;
      weights.emplace_back(a, b, 1.0 - a - b);
    }
  const auto add = [&](const Vec3& index) {
    const Vec3 p = lattice.place(index);
    x_.push_back(p.x);
    y_.push_back(p.y);
    z_.push_back(p.z);
  };
  x_.clear();
  y_.clear();
  z_.clear();
  // The mesh's vertices will be roots: what its triangles are off by is what is left when these values are subtracted.
  const bool first = subdivisions == 1;
  const std::size_t skip = first ? vertices_.size() : 0;
  if (first)
    for (const Vertex& v : vertices_) add(v.index);
  for (const Face& face : faces_)
    for (const Vec3& w : weights)
      add(w.x * vertices_[face.vertex[0]].index + w.y * vertices_[face.vertex[1]].index +
          w.z * vertices_[face.vertex[2]].index);
  f_.resize(x_.size());
  field.values({x_, y_, z_}, f_, {});
  evaluations_ += f_.size();
  for (std::size_t v = 0; v < skip; ++v) vertices_[v].value = f_[v];
  std::size_t i = skip;
  for (const Face& face : faces_)
    for (const Vec3& w : weights) {
      const double linear = w.x * vertices_[face.vertex[0]].value + w.y * vertices_[face.vertex[1]].value +
                            w.z * vertices_[face.vertex[2]].value;
      octants_[face.octant] = std::max(octants_[face.octant], std::abs(f_[i++] - linear) / face.slope);
    }
  return *std::max_element(octants_.begin(), octants_.end());
}

double BrickError::measure(double enough, const Lattice& lattice, const Field& field, const Brick& brick,
                           const BrickValues& values) {
  reconstruct(lattice, brick, values);
  double error = deviation(lattice, field, 1);
  if (error > enough) return error;
  error = std::max(error, hidden(enough, lattice, field, brick, values));
  if (error > enough) return error;
  const int subdivisions = std::min(1 << (brick.level - 1), kMostSubdivisions);
  if (subdivisions > 1) error = std::max(error, deviation(lattice, field, subdivisions));
  return error > enough ? error : std::max(error, buried(lattice, field, brick, values));
}

double BrickError::buried(const Lattice& lattice, const Field& field, const Brick& brick, const BrickValues& values) {
  const int probes = std::min((1 << brick.level) / 4, kMostSubdivisions);
  if (probes == 0) return 0.0;
  start();
  const Vec3 first(brick.first());
  const double stride = 1 << brick.level;
  const double reach = field.lipschitz() * 0.5 * stride * glm::length(lattice.step);
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

  void descend(const Cell& cell, int level, bool certain = false) {
    if (level == 0) {
      result_.leaves.push_back({cell.index, level});
      return;
    }
    const FieldPtr field = cell.field->narrow(lattice_.box(cell.index, level));
    unsigned certain_octants = 0;
    if (level <= lattice_.coarsest && !certain) {
      if (!is_coarse(cell.index, level, *field)) {
        result_.leaves.push_back({cell.index, level});
        KnownCell known{field, {}};
        if (!forced_) known.values = values_.all();
        result_.known.emplace_back(BrickPlace{cell.index, level}, std::move(known));
        return;
      }
      for (int octant = 0; octant < 8 && !forced_; ++octant)
        if (error_.octants()[octant] > kCertain * tolerance_) certain_octants |= 1u << octant;
    }
    result_.known.emplace_back(BrickPlace{cell.index, level}, KnownCell{field, {}});
    for (const Cell& child : children(lattice_, cell.index, level, field)) {
      const IVec3 at = child.index - 2 * cell.index;
      descend(child, level - 1, !certain && (certain_octants >> (at.x + 2 * at.y + 4 * at.z) & 1) != 0);
    }
  }

  Refinement take() {
    result_.evaluations += error_.evaluations();
    return std::move(result_);
  }

 private:
  bool is_coarse(const IVec3& index, int level, const Field& field) {
    if (forced_) return forced_({index, level});
    Brick brick(lattice_, index, level);
    values_.sample(lattice_, field, brick);
    result_.evaluations += BrickValues::count(brick);
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

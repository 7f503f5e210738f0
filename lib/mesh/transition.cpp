#include "transition.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "outcrop/mesh/marching_cubes.h"

namespace outcrop::meshing {
namespace {

constexpr int kHalfNodes = kHalves * kHalves * kHalves;

struct PieceCases {
  std::vector<PieceTriangle> triangles;
  std::vector<std::size_t> first{0};

  PieceCases(const CellShape& shape, const CaseTable& table) {
    for (int c = 0; c < 1 << shape.corners.size(); ++c) {
      for (const CellTriangle& t : table[c])
        triangles.push_back({{shape.edges[t[0]], shape.edges[t[1]], shape.edges[t[2]]}});
      first.push_back(triangles.size());
    }
  }
};

/// Four corners counter-clockwise from outside, and the middles between each and the next.
struct CellFace {
  IVec3 direction;
  std::array<IVec3, 4> corners, middles;
  IVec3 centre;
  /// For each side, the three other cells around it.
  std::array<std::array<IVec3, 3>, 4> around;
};

const std::array<CellFace, 6>& cell_faces() {
  static const std::array<CellFace, 6> faces = [] {
    std::array<CellFace, 6> list;
    for (int f = 0; f < 6; ++f) {
      CellFace& face = list[f];
      face.direction = IVec3(0);
      face.direction[f / 2] = f % 2 == 0 ? -1 : 1;
      face.centre = 1 + face.direction;
      const auto corners = cube_face(f / 2, f % 2);
      for (int i = 0; i < 4; ++i) face.corners[i] = 2 * corners[i];
      for (int i = 0; i < 4; ++i) {
        face.middles[i] = (face.corners[i] + face.corners[(i + 1) % 4]) / 2;
        const IVec3 sideways = face.middles[i] - face.centre;
        face.around[i] = {face.direction, sideways, face.direction + sideways};
      }
    }
    return list;
  }();
  return faces;
}

}  // namespace

std::span<const PieceTriangle> piece_triangles(bool tetrahedron, unsigned rock) {
  static const PieceCases pyramids(CellShape::pyramid(), CaseTable::pyramid());
  static const PieceCases tetrahedra(CellShape::tetrahedron(), CaseTable::tetrahedron());
  const PieceCases& cases = tetrahedron ? tetrahedra : pyramids;
  return std::span(cases.triangles).subspan(cases.first[rock], cases.first[rock + 1] - cases.first[rock]);
}

TransitionCells::TransitionCells() : values_(kHalfNodes), known_(kHalfNodes, 0), coned_(kNodes, 0) {}

template <class Visit>
void TransitionCells::for_each_face(const IVec3& cell, const FinerCells& finer, Visit&& visit) {
  const IVec3 origin = 2 * cell;
  for (const CellFace& face : cell_faces()) {
    FaceNodes nodes{.centre = half_number(origin + face.centre), .finer = finer.at(cell + face.direction)};
    for (int i = 0; i < 4; ++i) {
      nodes.corners[i] = half_number(origin + face.corners[i]);
      nodes.middles[i] = half_number(origin + face.middles[i]);
      nodes.divided[i] = nodes.finer || finer.at(cell + face.around[i][1]) || finer.at(cell + face.around[i][2]);
    }
    visit(nodes);
  }
}

template <class Visit>
void TransitionCells::for_each_piece(const IVec3& cell, const FinerCells& finer, Visit&& visit) const {
  const int centre = half_number(2 * cell + 1);
  for_each_face(cell, finer, [&](const FaceNodes& face) {
    const auto& corner = face.corners;
    const auto& half = face.middles;
    if (face.finer) {
      for (int i = 0; i < 4; ++i) visit(Piece{{corner[i], half[i], face.centre, half[(i + 3) % 4], centre}, false});
    } else if (!face.fan()) {
      visit(Piece{{corner[0], corner[1], corner[2], corner[3], centre}, false});
    } else {
      const int middle = face.centre;
      for (int i = 0; i < 4; ++i) {
        const int next = corner[(i + 1) % 4];
        if (face.divided[i]) {
          visit(Piece{{middle, corner[i], half[i], centre, 0}, true});
          visit(Piece{{middle, half[i], next, centre, 0}, true});
        } else {
          visit(Piece{{middle, corner[i], next, centre, 0}, true});
        }
      }
    }
  });
}

void TransitionCells::know_corner(int half, const BrickValues& values) {
  const IVec3 at = half_place(half);
  known_[half] = 1;
  values_[half] = values.at(at.x / 2 + 9 * (at.y / 2) + 81 * (at.z / 2));
}

void TransitionCells::want(int half) {
  if (known_[half]) return;
  known_[half] = 1;
  missing_.push_back(half);
}

void TransitionCells::count_rock(const FaceNodes& face, int& rock, int& nodes) const {
  const auto count = [&](int half) {
    rock += values_[half] < 0.0;
    ++nodes;
  };
  for (int i = 0; i < 4; ++i) {
    count(face.corners[i]);
    if (face.divided[i]) count(face.middles[i]);
  }
  if (known_[face.centre]) count(face.centre);
}

bool TransitionCells::mixed(const FaceNodes& face) const {
  int rock = 0, nodes = 0;
  count_rock(face, rock, nodes);
  return rock > 0 && rock < nodes;
}

void TransitionCells::find_cells(const Lattice& lattice, const Field& field, const Brick& brick,
                                 const BrickValues& values, const FinerCells& finer) {
  cells_.clear();
  std::fill(coned_.begin(), coned_.end(), 0);
  divided_.fill(0);
  const IVec3 n = brick.cells;
  // No point of a cell is farther from its nearest corner than this.
  const double reach = field.lipschitz() * 0.5 * glm::length(lattice.step) * (1 << brick.level) * (1.0 + 1e-9);
  for (int k = 0; k < n.z; ++k)
    for (int j = 0; j < n.y; ++j)
      for (int i = 0; i < n.x; ++i) {
        const bool inside = i > 0 && i + 1 < n.x && j > 0 && j + 1 < n.y && k > 0 && k + 1 < n.z;
        if (inside) continue;
        const IVec3 cell(i, j, k);
        const auto& directions = face_and_edge_neighbours();
        if (std::none_of(directions.begin(), directions.end(), [&](const IVec3& d) { return finer.at(cell + d); }))
          continue;
        const int node = i + 9 * j + 81 * k;
        coned_[node] = 1;
        double lowest = values.at(node), highest = lowest;
        for (int corner = 1; corner < 8; ++corner) {
          const double f = values.at(node + (corner & 1) + 9 * (corner >> 1 & 1) + 81 * (corner >> 2));
          lowest = std::min(lowest, f);
          highest = std::max(highest, f);
        }
        if (lowest <= reach && highest >= -reach) cells_.push_back(cell);
      }
  // Edges, seen from each of the four cells around them.
  for (int axis = 0; axis < 3; ++axis) {
    IVec3 u(0), v(0);
    u[(axis + 1) % 3] = 1;
    v[(axis + 2) % 3] = 1;
    for (int k = 0; k <= n.z - (axis == 2); ++k)
      for (int j = 0; j <= n.y - (axis == 1); ++j)
        for (int i = 0; i <= n.x - (axis == 0); ++i) {
          const IVec3 at(i, j, k);
          if (finer.at(at) || finer.at(at - u) || finer.at(at - v) || finer.at(at - u - v))
            divided_[(axis * 9 + k) * 9 + j] |= static_cast<std::uint16_t>(1u << i);
        }
  }
}

void TransitionCells::evaluate(const Lattice& lattice, const Field& field, const Brick& brick) {
  const Vec3 first(brick.first());
  const double half = 0.5 * (1 << brick.level);
  const std::size_t n = missing_.size();
  if (n == 0) return;
  x_.resize(n);
  y_.resize(n);
  z_.resize(n);
  f_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p = lattice.place(first + half * Vec3(half_place(missing_[i])));
    x_[i] = p.x;
    y_[i] = p.y;
    z_[i] = p.z;
  }
  field.values({x_, y_, z_}, f_, {});
  evaluations_ += n;
  for (std::size_t i = 0; i < n; ++i) values_[missing_[i]] = f_[i];
  missing_.clear();
}

bool TransitionCells::sample(const Lattice& lattice, const Field& field, const Brick& brick, const BrickValues& values,
                             const FinerCells& finer) {
  evaluations_ = 0;
  pieces_.clear();
  mixed_.clear();
  find_cells(lattice, field, brick, values, finer);
  if (cells_.empty()) return false;
  std::fill(known_.begin(), known_.end(), 0);

  // Nodes that finer cells have, too.
  for (const IVec3& cell : cells_)
    for_each_face(cell, finer, [&](const FaceNodes& face) {
      for (int i = 0; i < 4; ++i) {
        know_corner(face.corners[i], values);
        if (face.divided[i]) want(face.middles[i]);
      }
      if (face.finer) want(face.centre);
    });
  evaluate(lattice, field, brick);
  // Middles of other faces, and of cells: whether they are rock counts where the nodes around them differ; elsewhere
  // they are what those are, even if a look would show something else. Both cells at a face see the same.
  for (const IVec3& cell : cells_)
    for_each_face(cell, finer, [&](const FaceNodes& face) {
      if (face.fan() && mixed(face)) want(face.centre);
    });
  evaluate(lattice, field, brick);
  const auto is_mixed = [&](const IVec3& cell) {
    int rock = 0, nodes = 0;
    for_each_face(cell, finer, [&](const FaceNodes& face) { count_rock(face, rock, nodes); });
    return rock > 0 && rock < nodes;
  };
  std::copy_if(cells_.begin(), cells_.end(), std::back_inserter(mixed_), is_mixed);
  std::vector<std::pair<int, int>> unmixed;  // Middles of faces, each with a corner.
  for (const IVec3& cell : mixed_) {
    want(half_number(2 * cell + 1));
    for_each_face(cell, finer, [&](const FaceNodes& face) {
      if (!face.fan() || known_[face.centre]) return;
      want(face.centre);
      unmixed.emplace_back(face.centre, face.corners[0]);
    });
  }
  evaluate(lattice, field, brick);
  for (const auto& [centre, corner] : unmixed)
    if ((values_[centre] < 0.0) != (values_[corner] < 0.0)) values_[centre] = values_[corner];

  first_piece_ = {0};
  for (const IVec3& cell : mixed_) {
    for_each_piece(cell, finer, [&](const Piece& piece) {
      const int corners = piece.tetrahedron ? 4 : 5;
      int rock = 0;
      for (int i = 0; i < corners; ++i) rock += values_[piece.corners[i]] < 0.0;
      if (rock > 0 && rock < corners) pieces_.push_back(piece);
    });
    first_piece_.push_back(pieces_.size());
  }
  return !pieces_.empty();
}

}  // namespace outcrop::meshing

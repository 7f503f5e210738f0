#include "transition.h"

#include <algorithm>
#include <bit>
#include <cmath>
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

/// The cell at `direction` in FinerCells::around.
unsigned around_bit(const IVec3& direction) {
  return 1u << (direction.x + 1 + 3 * (direction.y + 1) + 9 * (direction.z + 1));
}

/// A face of a cell, its half nodes relative to the cell's first: four corners counter-clockwise from outside, and the
/// middles between each and the next.
struct CellFace {
  std::array<int, 4> corners, middles;
  int centre;
  unsigned beyond;                  ///< The cell there, as around_bit.
  std::array<unsigned, 4> besides;  ///< For each side, the three other cells around it.
};

/// An edge of a cell.
struct CellEdge {
  std::array<int, 2> corners;
  int middle;
  unsigned besides;  ///< The three other cells around it.
};

struct CellParts {
  std::array<CellFace, 6> faces;
  std::array<CellEdge, 12> edges;

  CellParts() {
    std::size_t edge = 0;
    for (int f = 0; f < 6; ++f) {
      CellFace& face = faces[f];
      IVec3 beyond(0);
      beyond[f / 2] = f % 2 == 0 ? -1 : 1;
      face.beyond = around_bit(beyond);
      face.centre = half_number(1 + beyond);
      const auto corners = cube_face(f / 2, f % 2);
      for (int i = 0; i < 4; ++i) {
        const IVec3 a = 2 * corners[i], b = 2 * corners[(i + 1) % 4];
        const IVec3 sideways = (a + b) / 2 - (1 + beyond);
        face.corners[i] = half_number(a);
        face.middles[i] = half_number((a + b) / 2);
        face.besides[i] = face.beyond | around_bit(sideways) | around_bit(beyond + sideways);
        // Each edge is a side of two faces.
        const auto end = edges.begin() + static_cast<std::ptrdiff_t>(edge);
        const auto is_known = [&](const CellEdge& e) { return e.middle == face.middles[i]; };
        if (std::none_of(edges.begin(), end, is_known))
          edges[edge++] = {{face.corners[i], half_number(b)}, face.middles[i], face.besides[i]};
      }
    }
  }
};

const CellParts& cell_parts() {
  static const CellParts parts;
  return parts;
}

}  // namespace

std::span<const PieceTriangle> piece_triangles(bool tetrahedron, unsigned rock) {
  static const PieceCases pyramids(CellShape::pyramid(), CaseTable::pyramid());
  static const PieceCases tetrahedra(CellShape::tetrahedron(), CaseTable::tetrahedron());
  const PieceCases& cases = tetrahedron ? tetrahedra : pyramids;
  return std::span(cases.triangles).subspan(cases.first[rock], cases.first[rock + 1] - cases.first[rock]);
}

TransitionCells::TransitionCells() : values_(kHalfNodes), known_(kHalfNodes), coned_(kNodes, 0) {}

template <class Visit>
void TransitionCells::for_each_face(const Cell& cell, Visit&& visit) {
  for (const CellFace& face : cell_parts().faces) {
    FaceNodes nodes{.centre = cell.half + face.centre, .finer = (cell.finer & face.beyond) != 0};
    for (int i = 0; i < 4; ++i) {
      nodes.corners[i] = cell.half + face.corners[i];
      nodes.middles[i] = cell.half + face.middles[i];
      nodes.divided[i] = (cell.finer & face.besides[i]) != 0;
    }
    visit(nodes);
  }
}

template <class Visit>
void TransitionCells::for_each_shared(const Cell& cell, Visit&& visit) {
  for (const CellEdge& edge : cell_parts().edges)
    if (cell.finer & edge.besides) visit(cell.half + edge.middle, edge.corners);
  for (const CellFace& face : cell_parts().faces)
    if (cell.finer & face.beyond) visit(cell.half + face.centre, face.corners);
}

template <class Visit>
void TransitionCells::for_each_piece(const Cell& cell, Visit&& visit) {
  const int centre = cell.half + half_number(IVec3(1));
  for_each_face(cell, [&](const FaceNodes& face) {
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

void TransitionCells::want(int half) {
  if (known_[half] == Known::Value) return;
  known_[half] = Known::Value;
  missing_.push_back(half);
}

bool TransitionCells::is_mixed(const FaceNodes& face) const {
  bool rock = false, air = false;
  for (int i = 0; i < 4; ++i)
    for (const int half : {face.corners[i], face.divided[i] ? face.middles[i] : face.corners[i]})
      (values_[half] < 0.0 ? rock : air) = true;
  return rock && air;
}

void TransitionCells::find_cells(const Lattice& lattice, const Field& field, const Brick& brick,
                                 const BrickValues& values, const FinerCells& finer) {
  cells_.clear();
  std::fill(coned_.begin(), coned_.end(), 0);
  divided_.fill(0);
  const IVec3 n = brick.cells;
  // No point of a cell is farther from its nearest corner than this.
  const double reach = clear_value(field, 0.5 * glm::length(lattice.step) * (1 << brick.level));
  for (int k = 0; k < n.z; ++k)
    for (int j = 0; j < n.y; ++j) {
      const auto row = [&](int y, int z) { return finer.row(j + y, k + z); };
      // Bit x + 1 stands for cell x: cells beside it, and cells anywhere from before to behind it.
      const unsigned beside = row(-1, -1) | row(1, -1) | row(-1, 1) | row(1, 1);
      const unsigned near = row(-1, 0) | row(1, 0) | row(0, -1) | row(0, 1);
      const unsigned ends = row(0, 0) | near;
      const unsigned coned = (beside | near | ends << 1 | ends >> 1) >> 1;
      for (unsigned bits = coned & ((1u << n.x) - 1); bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits), node = i + 9 * j + 81 * k;
        coned_[node] = 1;
        double lowest = values.at(node), highest = lowest;
        for (const int corner : {1, 9, 10, 81, 82, 90, 91}) {
          lowest = std::min(lowest, values.at(node + corner));
          highest = std::max(highest, values.at(node + corner));
        }
        if (lowest > reach || highest < -reach) continue;
        const IVec3 place(i, j, k);
        cells_.push_back({place, half_number(2 * place), finer.around(place), lowest < 0.0, highest >= 0.0});
      }
    }
  // Edges, seen from each of the four cells around them.
  for (int k = 0; k <= n.z; ++k)
    for (int j = 0; j <= n.y; ++j) {
      const unsigned here = finer.row(j, k), below = finer.row(j, k - 1), before = finer.row(j - 1, k);
      const auto set = [&](int axis, unsigned bits, int edges) {
        divided_[(axis * 9 + k) * 9 + j] = static_cast<std::uint16_t>(bits & ((1u << edges) - 1));
      };
      const unsigned y = here | below, z = here | before;
      set(0, (y | before | finer.row(j - 1, k - 1)) >> 1, n.x);
      if (j < n.y) set(1, y >> 1 | y, n.x + 1);
      if (k < n.z) set(2, z >> 1 | z, n.x + 1);
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
  std::fill(known_.begin(), known_.end(), Known::Nothing);
  for (int k = 0; k <= brick.cells.z; ++k)
    for (int j = 0; j <= brick.cells.y; ++j)
      for (int i = 0; i <= brick.cells.x; ++i) values_[half_number(2 * IVec3(i, j, k))] = values.at(i + 9 * j + 81 * k);

  // Nodes that finer cells have, too; far from the surface a corner's sign is theirs.
  const Vec3 sides = lattice.step * double(1 << brick.level);
  const double to_middle = clear_value(field, 0.5 * std::max({sides.x, sides.y, sides.z}));
  const double to_centre = clear_value(field, 0.5 * glm::length(sides));
  for (const Cell& cell : cells_)
    for_each_shared(cell, [&](int half, const auto& corners) {
      if (known_[half] != Known::Nothing) return;
      for (const int corner : corners) {
        const double f = values_[cell.half + corner];
        if (std::abs(f) <= (corners.size() == 2 ? to_middle : to_centre)) continue;
        known_[half] = Known::Sign;
        values_[half] = f;
        return;
      }
      want(half);
    });
  evaluate(lattice, field, brick);
  // Middles of other faces, and of cells: whether they are rock counts where the nodes around them differ; elsewhere
  // they are what those are, even if a look would show something else. Both cells at a face see the same.
  unmixed_.clear();
  for (Cell& cell : cells_) {
    for_each_shared(cell, [&](int half, const auto&) { (values_[half] < 0.0 ? cell.rock : cell.air) = true; });
    if (!cell.rock || !cell.air) continue;
    mixed_.push_back(cell);
    for_each_shared(cell, [&](int half, const auto&) { want(half); });
    want(cell.half + half_number(IVec3(1)));
    for_each_face(cell, [&](const FaceNodes& face) {
      if (!face.fan()) return;
      want(face.centre);
      if (!is_mixed(face)) unmixed_.emplace_back(face.centre, face.corners[0]);
    });
  }
  evaluate(lattice, field, brick);
  for (const auto& [centre, corner] : unmixed_)
    if ((values_[centre] < 0.0) != (values_[corner] < 0.0)) values_[centre] = values_[corner];

  first_piece_ = {0};
  for (const Cell& cell : mixed_) {
    for_each_piece(cell, [&](const Piece& piece) {
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

#include "cell_fan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "flat_map.h"

namespace outcrop::meshing {
namespace {

/// Normals that differ by more say that there is a crease, Kobbelt et al. 2001, section 4: cos 25°.
constexpr double kCreaseCosine = 0.9;
/// Pull towards the middle of the polygon, for each of its corners: what no tangent plane decides stays there.
constexpr double kPull = 0.005;
/// Values this small, as a share of what f changes along a line through the cell, may be rounding on either side of 0.
constexpr double kRounding = 1e-6;
/// A triangle of the fan is at least so high over the polygon's side, as a share of the cell's edge.
constexpr double kLeastHeight = 0.02;
/// A crease is drawn where that takes the error to at most this share.
constexpr double kGain = 0.5;

/// A coned cell has at most 24 pyramids of up to four triangles, or 48 tetrahedra of two.
constexpr std::size_t kMostTriangles = 96;

using Triangle = std::array<std::uint32_t, 3>;

/// Is the triangle of a fan counter-clockwise seen along `up`, and not flat?
bool turns_clearly(const Vec3& up, const Vec3& apex, const Vec3& a, const Vec3& b, double cell) {
  return glm::dot(up, glm::cross(a - apex, b - apex)) > kLeastHeight * cell * glm::length(b - a);
}

Vec3 area_normal(std::span<const std::uint32_t> loop, std::span<const Vec3f> positions) {
  Vec3 sum(0.0);
  const Vec3 origin(positions[loop[0]]);
  for (std::size_t i = 1; i + 1 < loop.size(); ++i)
    sum += glm::cross(Vec3(positions[loop[i]]) - origin, Vec3(positions[loop[i + 1]]) - origin);
  const double length = glm::length(sum);
  return length > 0.0 ? sum / length : Vec3(0.0);
}

}  // namespace

std::vector<std::uint32_t> boundary_loop(std::span<const Triangle> triangles) {
  if (triangles.size() > kMostTriangles) return {};
  std::array<std::uint64_t, 3 * kMostTriangles> sides;  // Start and end in one number.
  auto end = sides.begin();
  const auto side = [](std::uint64_t a, std::uint64_t b) { return a << 32 | b; };
  for (const Triangle& t : triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      const auto opposite = std::find(sides.begin(), end, side(b, a));
      if (opposite == end)
        *end++ = side(a, b);
      else
        *opposite = *--end;
    }
  const auto count = static_cast<std::size_t>(end - sides.begin());
  if (count < 3) return {};
  std::vector<std::uint32_t> loop;
  loop.reserve(count);
  const auto start = [](std::uint64_t s) { return static_cast<std::uint32_t>(s >> 32); };
  std::uint32_t at = start(sides.front());
  while (loop.size() < count) {
    if (std::find(loop.begin(), loop.end(), at) != loop.end()) return {};
    loop.push_back(at);
    at = static_cast<std::uint32_t>(
        *std::find_if(sides.begin(), end, [&](std::uint64_t s) { return start(s) == at; }));
  }
  return loop;
}

void CellFans::clear() {
  cells_.clear();
  loops_.clear();
  triangles_.clear();
}

void CellFans::add(const IVec3& first, int edge, std::span<const std::uint32_t> loop,
                   std::span<const Triangle> triangles, double tolerance) {
  cells_.push_back({first, edge, loops_.size(), loop.size(), triangles_.size(), triangles.size(), tolerance, {}});
  loops_.insert(loops_.end(), loop.begin(), loop.end());
  triangles_.insert(triangles_.end(), triangles.begin(), triangles.end());
}

void CellFans::gather(const Vec3& p) {
  x_.push_back(p.x);
  y_.push_back(p.y);
  z_.push_back(p.z);
}

void CellFans::evaluate(const Field& field) {
  f_.resize(x_.size());
  field.values({x_, y_, z_}, f_, {});
  evaluations_ += f_.size();
  for (std::vector<double>* values : {&x_, &y_, &z_}) values->clear();
}

bool CellFans::find_line(const Lattice& lattice, Cell& cell, std::span<const Vec3f> positions,
                         std::span<const Vec3f> normals, Line& line) const {
  const auto corners = std::span(loops_).subspan(cell.loop, cell.corners);
  double least_cosine = 1.0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least_cosine = std::min<double>(least_cosine, glm::dot(normals[corners[i]], normals[corners[j]]));
  cell.fan.crease = least_cosine < kCreaseCosine;
  if (cell.triangles > 0 && !cell.fan.crease) return false;
  const Vec3 up = area_normal(corners, positions);
  if (up == Vec3(0.0)) return false;
  cell.fan.up = up;

  Vec3 middle(0.0);
  for (const std::uint32_t v : corners) middle += Vec3(positions[v]);
  middle /= static_cast<double>(corners.size());
  glm::dmat3 sum(kPull * static_cast<double>(corners.size()));
  Vec3 right(0.0);
  for (const std::uint32_t v : corners) {
    const Vec3 n(normals[v]);
    sum += glm::outerProduct(n, n);
    right += n * glm::dot(n, Vec3(positions[v]) - middle);
  }
  const Vec3 size = static_cast<double>(cell.edge) * lattice.step;
  const Vec3 start = lattice.lo - lattice.origin;
  const Vec3 lo = start + Vec3(cell.first) * lattice.step, hi = lo + size;
  const Vec3 best = glm::clamp(middle + glm::inverse(sum) * right, lo + kEndShare * size, hi - kEndShare * size);

  // Up and down to the cell's faces, and not beyond half a cell.
  double below = -0.5 * size.z, above = 0.5 * size.z;
  for (int axis = 0; axis < 3; ++axis) {
    if (up[axis] == 0.0) continue;
    const double a = (lo[axis] - best[axis]) / up[axis], b = (hi[axis] - best[axis]) / up[axis];
    below = std::max(below, std::min(a, b));
    above = std::min(above, std::max(a, b));
  }
  line.from = (best + below * up - start) / lattice.step;
  line.along = (above - below) * up / lattice.step;
  return above > below;
}

bool CellFans::is_embedded(const Lattice& lattice, const Cell& cell, std::span<const Vec3f> positions) const {
  const auto corners = std::span(loops_).subspan(cell.loop, cell.corners);
  const Vec3 apex(cell.fan.position), up = cell.fan.up;
  const Vec3 side = glm::cross(up, std::abs(up.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
  int turns = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a(positions[corners[i]]), b(positions[corners[(i + 1) % corners.size()]]);
    if (!turns_clearly(up, apex, a, b, cell.edge * lattice.step.z)) return false;
    // Each triangle turns by less than half a turn, so that this counts the turns of all.
    turns += glm::dot(side, a - apex) < 0.0 && glm::dot(side, b - apex) >= 0.0;
  }
  return turns == 1;
}

void CellFans::judge(const Lattice& lattice, const Field& field, std::span<const Vec3f> positions,
                     std::span<const Vec3f> normals) {
  // Three points a triangle, halfway between its middle and its corners.
  const auto look = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3& corner : {a, b, c}) gather(lattice.origin + (0.5 * corner + (a + b + c) / 6.0));
  };
  const auto for_each_side = [&](const Cell& cell, const auto& visit) {
    const auto corners = std::span(loops_).subspan(cell.loop, cell.corners);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::uint32_t a = corners[i], b = corners[(i + 1) % corners.size()];
      // Where a crease crosses the polygon, the fan is off as the triangles were.
      if (cell.triangles == 0 || glm::dot(normals[a], normals[b]) >= kCreaseCosine) visit(a, b);
    }
  };
  // Where normals agree the fan, whose vertices lie on the surface, is as good as what the brick was measured with.
  const auto needs_look = [](const Cell& cell) { return cell.fan.taken && cell.fan.crease; };
  for (const Cell& cell : cells_) {
    if (!needs_look(cell)) continue;
    for_each_side(cell, [&](std::uint32_t a, std::uint32_t b) {
      look(Vec3(positions[a]), Vec3(positions[b]), Vec3(cell.fan.position));
    });
    for (const Triangle& t : std::span(triangles_).subspan(cell.triangle, cell.triangles))
      look(Vec3(positions[t[0]]), Vec3(positions[t[1]]), Vec3(positions[t[2]]));
  }
  evaluate(field);
  std::size_t at = 0;
  const auto take_worst = [&](double& most) {
    for (int i = 0; i < 3; ++i) most = std::max(most, std::abs(f_[at++]));
  };
  for (Cell& cell : cells_) {
    if (!needs_look(cell)) continue;
    double with = 0.0, without = 0.0;
    for_each_side(cell, [&](std::uint32_t, std::uint32_t) { take_worst(with); });
    for (std::size_t t = 0; t < cell.triangles; ++t) take_worst(without);
    const double allowed = cell.tolerance * glm::length(cell.fan.gradient);
    cell.fan.taken = cell.triangles > 0 ? without > allowed && with < kGain * without : with <= allowed;
  }
}

std::size_t CellFans::solve(const Lattice& lattice, const Field& field, std::span<const Vec3f> positions,
                            std::span<const Vec3f> normals) {
  evaluations_ = 0;
  lines_.clear();
  solver_.clear();
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    Line line{.cell = c};
    if (!find_line(lattice, cells_[c], positions, normals, line)) continue;
    lines_.push_back(line);
    gather(lattice.place(line.from));
    gather(lattice.place(line.from + line.along));
  }
  if (lines_.empty()) return 0;
  evaluate(field);
  std::size_t left = 0;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const double below = f_[2 * i], above = f_[2 * i + 1];
    if (!(below < 0.0 && above >= 0.0)) continue;
    lines_[left++] = lines_[i];
    solver_.add(lines_[i].from, lines_[i].along, below, above);
  }
  evaluations_ += solver_.solve(lattice, field, true);
  for (std::size_t i = 0; i < left; ++i) {
    Cell& cell = cells_[lines_[i].cell];
    const Vec3 first(cell.first), margin(kEndShare * cell.edge);
    const Vec3 index = glm::clamp(solver_.index(i), first + margin, first + double(cell.edge) - margin);
    cell.fan.position = lattice.local(index);
    cell.fan.gradient = solver_.gradients()[i];
    const double slope = glm::length(cell.fan.gradient);
    cell.fan.taken = slope > 0.0 && std::isfinite(slope) && is_embedded(lattice, cell, positions);
  }
  judge(lattice, field, positions, normals);
  return evaluations_;
}

namespace {

/// A side of a polygon with the triangles of the two fans beside it.
struct SharedSide {
  std::array<std::size_t, 2> apexes, triangles;
};

std::vector<SharedSide> shared_sides(std::span<const Apex> apexes, std::span<const Triangle> triangles) {
  struct Seen {
    std::size_t apex = 0, triangle = 0;
    bool set = false;
  };
  FlatMap<Seen> seen;
  std::vector<SharedSide> sides;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, vertex] = triangles[t];
    const auto apex = std::lower_bound(apexes.begin(), apexes.end(), vertex,
                                       [](const Apex& other, std::uint32_t v) { return other.vertex < v; });
    if (apex == apexes.end() || apex->vertex != vertex) continue;
    Seen& before = seen[static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b)];
    const auto i = static_cast<std::size_t>(apex - apexes.begin());
    if (before.set)
      sides.push_back({{std::min(i, before.apex), std::max(i, before.apex)}, {t, before.triangle}});
    else
      before = {i, t, true};
  }
  std::sort(sides.begin(), sides.end(), [](const SharedSide& a, const SharedSide& b) {
    return std::tie(a.apexes, a.triangles) < std::tie(b.apexes, b.triangles);
  });
  return sides;
}

}  // namespace

void join_creases(const Lattice& lattice, std::span<const Apex> apexes, std::span<const Vec3f> positions,
                  std::span<const Vec3f> normals, std::span<Triangle> triangles) {
  if (apexes.empty()) return;
  const std::vector<SharedSide> sides = shared_sides(apexes, triangles);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto same = [&](std::size_t other) {
      return other < sides.size() && sides[other].apexes == sides[i].apexes;
    };
    if (same(i + 1) || (i > 0 && same(i - 1))) continue;  // The face carries two sides.
    Triangle &first = triangles[sides[i].triangles[0]], &second = triangles[sides[i].triangles[1]];
    const auto [a, b, u] = first;
    const std::uint32_t v = second[2];
    if (glm::dot(normals[a], normals[b]) >= kCreaseCosine) continue;
    const auto apex_of = [&](std::uint32_t vertex) -> const Apex& {
      return apexes[sides[i].apexes[apexes[sides[i].apexes[0]].vertex == vertex ? 0 : 1]];
    };
    const Apex &from = apex_of(u), &to = apex_of(v);
    const IVec3 across = to.cell - from.cell, face = glm::max(from.cell, to.cell);
    const int axis = across.x != 0 ? 0 : across.y != 0 ? 1 : 2;
    const Vec3 p(positions[u]), q(positions[v]), pa(positions[a]), pb(positions[b]);
    const double plane = lattice.local(axis, face[axis]);
    const Vec3 through = p + (plane - p[axis]) / (q[axis] - p[axis]) * (q - p);
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      const double along = (through[k] + lattice.origin[k] - lattice.lo[k]) / lattice.step[k] - face[k];
      inside = inside && (k == axis || (along > kLeastHeight && along < 1.0 - kLeastHeight));
    }
    const double cell = lattice.step.z;
    if (!inside || !turns_clearly(from.up, p, pa, through, cell) || !turns_clearly(from.up, p, through, pb, cell) ||
        !turns_clearly(to.up, q, pb, through, cell) || !turns_clearly(to.up, q, through, pa, cell))
      continue;
    first = {u, a, v};
    second = {v, b, u};
  }
}

}  // namespace outcrop::meshing

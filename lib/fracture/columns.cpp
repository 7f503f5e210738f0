#include <algorithm>
#include <cmath>

#include "region.h"
#include "wrapped_grid.h"

namespace outcrop {
namespace {

constexpr double kHexagonArea = 0.8660254037844386;  // √3/2: of a hexagon of width 1 across its flats.
constexpr double kRelaxations = 3.0;  // Lloyd's steps at an irregularity of 1/2: cooling rock evens its columns out.
constexpr double kMostRelaxations = 64.0;
constexpr int kSeedAttempts = 24;
constexpr double kSeedSpacing = 0.75;  // Of the column width: wished between seeds; about the densest that darts reach.
constexpr double kReach = 2.5;         // Of the column width: neighbours of a Voronoi cell are within it.

struct Edge {
  Vec2 from;  // Relative to the seed; counter-clockwise.
  Vec3 normal;
  double distance;  // Of the edge from the seed.
};

// Cuts a convex polygon by n · p ≤ distance.
std::vector<Edge> cut(const std::vector<Edge>& polygon, const Vec3& n, double distance) {
  std::vector<Edge> result;
  const auto height = [&](const Vec2& p) { return n.x * p.x + n.y * p.y - distance; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Edge& edge = polygon[i];
    const Vec2 next = polygon[(i + 1) % polygon.size()].from;
    const double a = height(edge.from);
    const double b = height(next);
    if (a <= 0.0) result.push_back(edge);
    if (a <= 0.0 && b > 0.0) result.push_back({edge.from + a / (a - b) * (next - edge.from), n, distance});
    if (a > 0.0 && b <= 0.0)
      result.push_back({edge.from + a / (a - b) * (next - edge.from), edge.normal, edge.distance});
  }
  return result;
}

/// The torus that seeds see each other around, or the box in which they do not.
struct Ground {
  double side;
  bool boxed;

  [[nodiscard]] Vec3 difference(const Vec3& a, const Vec3& b) const {
    return boxed ? b - a : wrapped_difference(a, b, side);
  }
};

std::vector<Edge> voronoi_cell(const std::vector<Vec3>& seeds, const WrappedGrid& grid, std::size_t i,
                               const Ground& ground) {
  const Vec2 lo = ground.boxed ? -Vec2(seeds[i]) : Vec2(-0.5 * ground.side);
  const Vec2 hi = lo + ground.side;
  std::vector<Edge> cell{{lo, {0, -1, 0}, -lo.y},
                         {{hi.x, lo.y}, {1, 0, 0}, hi.x},
                         {hi, {0, 1, 0}, hi.y},
                         {{lo.x, hi.y}, {-1, 0, 0}, -lo.x}};
  std::vector<std::pair<double, std::uint32_t>> near;
  grid.visit_near(seeds[i], [&](std::uint32_t j) {
    if (j != i) near.emplace_back(glm::length(ground.difference(seeds[i], seeds[j])), j);
  });
  std::sort(near.begin(), near.end());
  for (const auto& [distance, j] : near) {
    double reach = 0.0;
    for (const Edge& edge : cell) reach = std::max(reach, glm::length(edge.from));
    if (distance > 2.0 * reach) break;
    cell = cut(cell, ground.difference(seeds[i], seeds[j]) / distance, 0.5 * distance);
  }
  return cell;
}

Vec2 centroid(const std::vector<Edge>& polygon) {
  Vec2 sum{0.0};
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i].from;
    const Vec2& b = polygon[(i + 1) % polygon.size()].from;
    const double twice = a.x * b.y - a.y * b.x;
    area += twice;
    sum += twice * (a + b) / 3.0;
  }
  return sum / area;
}

WrappedGrid grid_of(const std::vector<Vec3>& seeds, double side, double reach) {
  WrappedGrid grid(side, reach);
  for (const Vec3& seed : seeds) grid.insert(seed);
  return grid;
}

// Rows of a hexagonal lattice, stretched to fit the torus.
std::vector<Vec3> hexagonal_seeds(double side, double width) {
  const int along = std::max(1, static_cast<int>(std::lround(side / width)));
  const int rows = 2 * std::max(1, static_cast<int>(std::lround(0.5 * side / (kHexagonArea * width))));
  std::vector<Vec3> seeds;
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < along; ++i)
      seeds.push_back({side * (i + 0.25 + 0.5 * (row % 2)) / along, side * (row + 0.5) / rows, 0.0});
  return seeds;
}

// Blue noise: each seed has the most room among a few candidates.
std::vector<Vec3> scattered_seeds(double side, double width, std::uint64_t first_stream, Seed seed) {
  const auto count = static_cast<std::size_t>(std::lround(side * side / (kHexagonArea * width * width)));
  const double spacing = kSeedSpacing * width;
  WrappedGrid grid(side, width);
  std::vector<Vec3> seeds;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(seed, "columns", first_stream + i);
    Vec3 best{0.0};
    double best_room = -1.0;
    for (int attempt = 0; attempt < kSeedAttempts && best_room < spacing; ++attempt) {
      const double x = side * rng.uniform();
      const double y = side * rng.uniform();
      double room = spacing;
      grid.visit_near({x, y, 0}, [&](std::uint32_t j) {
        room = std::min(room, wrapped_distance({x, y, 0}, seeds[j], side));
      });
      if (room > best_room) {
        best_room = room;
        best = {x, y, 0};
      }
    }
    seeds.push_back(best);
    grid.insert(best);
  }
  return seeds;
}

// Lloyd's step: every seed to the middle of its cell.
std::vector<Vec3> relaxed(const std::vector<Vec3>& seeds, const Ground& ground, double width) {
  const double side = ground.side;
  const WrappedGrid near = grid_of(seeds, side, kReach * width);
  std::vector<Vec3> moved(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const Vec2 middle = centroid(voronoi_cell(seeds, near, i, ground));
    for (int axis = 0; axis < 2; ++axis) {
      const double v = seeds[i][axis] + middle[axis];
      moved[i][axis] = std::clamp(v - side * std::floor(v / side), 0.0, std::nextafter(side, 0.0));
    }
  }
  return moved;
}

std::vector<Vec3> column_seeds(const Ground& ground, const ColumnTier& tier, std::size_t number, Seed seed) {
  const double side = ground.side;
  if (tier.irregularity == 0.0) return hexagonal_seeds(side, tier.width);
  std::vector<Vec3> seeds = scattered_seeds(side, tier.width, std::uint64_t{number} << 32, seed);
  const double steps = std::min(kMostRelaxations, std::round(kRelaxations * (1.0 / tier.irregularity - 1.0)));
  for (int step = 0; step < static_cast<int>(steps); ++step) seeds = relaxed(seeds, ground, tier.width);
  return seeds;
}

// The columns of one tier; samples are those listed, which lie in it.
std::vector<Region> tier_regions(const std::vector<Vec3>& samples, const std::vector<std::uint32_t>& own,
                                 const Ground& ground, const ColumnTier& tier, std::size_t number, Seed seed) {
  const double side = ground.side;
  const double width = tier.width;
  const std::vector<Vec3> seeds = column_seeds(ground, tier, number, seed);
  const WrappedGrid grid = grid_of(seeds, side, kReach * width);
  std::vector<Region> columns(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    columns[i].periods = {{0, 0, 1}};
    for (const Edge& edge : voronoi_cell(seeds, grid, i, ground))
      columns[i].walls.push_back({{edge.normal, -glm::dot(edge.normal, seeds[i]) - edge.distance}, kColumnJoint});
  }
  const SortedCells near(seeds, side, width);  // wide enough for almost every sample
  for (const std::uint32_t k : own) {
    const Vec3 foot(samples[k].x, samples[k].y, 0.0);
    std::size_t nearest = 0;
    double least = width * width;
    const auto consider = [&](const Vec3& d, std::uint32_t j) {
      if (const double square = glm::dot(d, d); square < least) {
        least = square;
        nearest = j;
      }
    };
    near.visit_near(foot, [&](std::span<const SortedCells::Entry> some, const Vec3& turn) {
      if (ground.boxed && turn != Vec3(0.0)) return;
      for (const auto& [p, j] : some) consider(p + turn - foot, j);
    });
    if (least == width * width) {
      least = 1e300;
      grid.visit_near(foot, [&](std::uint32_t j) { consider(ground.difference(foot, seeds[j]), j); });
    }
    columns[nearest].samples.push_back(k);
    const Vec3 position = seeds[nearest] + ground.difference(seeds[nearest], foot);
    columns[nearest].positions.push_back({position.x, position.y, samples[k].z});
  }
  return columns;
}

}  // namespace

std::vector<Region> column_regions(const std::vector<Vec3>& samples, double side, const std::vector<ColumnTier>& tiers,
                                   bool boxed, Seed seed) {
  double heights = 0.0;
  for (const ColumnTier& tier : tiers) heights += tier.height;
  std::vector<Region> columns;
  double floor = 0.0;
  for (std::size_t t = 0; t < tiers.size(); ++t) {
    const double ceiling = t + 1 < tiers.size() ? floor + side * tiers[t].height / heights : side;
    std::vector<std::uint32_t> own;
    for (std::uint32_t k = 0; k < samples.size(); ++k)
      if (samples[k].z >= floor && samples[k].z < ceiling) own.push_back(k);
    for (Region& column : tier_regions(samples, own, {side, boxed}, tiers[t], t, seed)) {
      if (tiers.size() > 1) {
        column.periods.clear();
        column.walls.push_back({{{0, 0, -1}, floor}, kTierJoint});
        column.walls.push_back({{{0, 0, 1}, -ceiling}, kTierJoint});
      }
      columns.push_back(std::move(column));
    }
    floor = ceiling;
  }
  return columns;
}

}  // namespace outcrop

#include <algorithm>
#include <cmath>

#include "region.h"
#include "wrapped_grid.h"

namespace outcrop {
namespace {

constexpr double kHexagonArea = 0.8660254037844386;  // √3/2: of a hexagon of width 1 across its flats.
constexpr int kRelaxations = 3;  // Lloyd's steps: cooling rock evens its columns out, but not to hexagons.
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

std::vector<Edge> voronoi_cell(const std::vector<Vec3>& seeds, const WrappedGrid& grid, std::size_t i, double side) {
  const double half = 0.5 * side;
  std::vector<Edge> cell{{{-half, -half}, {0, -1, 0}, half},
                         {{half, -half}, {1, 0, 0}, half},
                         {{half, half}, {0, 1, 0}, half},
                         {{-half, half}, {-1, 0, 0}, half}};
  std::vector<std::pair<double, std::uint32_t>> near;
  grid.visit_near(seeds[i], [&](std::uint32_t j) {
    if (j != i) near.emplace_back(wrapped_distance(seeds[i], seeds[j], side), j);
  });
  std::sort(near.begin(), near.end());
  for (const auto& [distance, j] : near) {
    double reach = 0.0;
    for (const Edge& edge : cell) reach = std::max(reach, glm::length(edge.from));
    if (distance > 2.0 * reach) break;
    cell = cut(cell, wrapped_difference(seeds[i], seeds[j], side) / distance, 0.5 * distance);
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

std::vector<Vec3> column_seeds(double side, double width, Seed seed) {
  const auto count = static_cast<std::size_t>(std::lround(side * side / (kHexagonArea * width * width)));
  const double spacing = kSeedSpacing * width;
  WrappedGrid grid(side, width);
  std::vector<Vec3> seeds;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(seed, "columns", i);
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
  for (int step = 0; step < kRelaxations; ++step) {
    const WrappedGrid near = grid_of(seeds, side, kReach * width);
    std::vector<Vec3> moved(seeds.size());
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      const Vec2 middle = centroid(voronoi_cell(seeds, near, i, side));
      for (int axis = 0; axis < 2; ++axis) {
        const double v = seeds[i][axis] + middle[axis];
        moved[i][axis] = std::clamp(v - side * std::floor(v / side), 0.0, std::nextafter(side, 0.0));
      }
    }
    seeds = std::move(moved);
  }
  return seeds;
}

}  // namespace

std::vector<Region> column_regions(const std::vector<Vec3>& samples, double side, double width, Seed seed) {
  const std::vector<Vec3> seeds = column_seeds(side, width, seed);
  const WrappedGrid grid = grid_of(seeds, side, kReach * width);
  std::vector<Region> columns(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    columns[i].periods = {{0, 0, 1}};
    for (const Edge& edge : voronoi_cell(seeds, grid, i, side))
      columns[i].walls.push_back({{edge.normal, -glm::dot(edge.normal, seeds[i]) - edge.distance}, kColumnJoint});
  }
  const SortedCells near(seeds, side, width);  // wide enough for almost every sample
  for (std::uint32_t k = 0; k < samples.size(); ++k) {
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
      for (const auto& [p, j] : some) consider(p + turn - foot, j);
    });
    if (least == width * width) {
      least = 1e300;
      grid.visit_near(foot, [&](std::uint32_t j) { consider(wrapped_difference(foot, seeds[j], side), j); });
    }
    columns[nearest].samples.push_back(k);
    const Vec3 position = seeds[nearest] + wrapped_difference(seeds[nearest], foot, side);
    columns[nearest].positions.push_back({position.x, position.y, samples[k].z});
  }
  return columns;
}

}  // namespace outcrop

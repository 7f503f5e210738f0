#include "nodata.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "outcrop/core/parallel.h"
#include "outcrop/terrain/distance_transform.h"

namespace outcrop::terrain {
namespace {

constexpr int kSweeps = 8;  // Gauss-Seidel sweeps a level; the level above has removed all longer waves.
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Samples of which some are known; unknown ones are NaN until they are filled.
struct Level {
  int width, height;
  std::vector<float> values;
  std::vector<std::uint8_t> known;

  [[nodiscard]] std::size_t index(int c, int r) const noexcept { return static_cast<std::size_t>(r) * width + c; }
  [[nodiscard]] bool complete() const noexcept {
    return std::all_of(known.begin(), known.end(), [](std::uint8_t k) { return k != 0; });
  }
};

/// Half the resolution: the means of what is known in 2 x 2 samples.
Level coarser(const Level& fine) {
  const int width = (fine.width + 1) / 2, height = (fine.height + 1) / 2;
  const std::size_t count = static_cast<std::size_t>(width) * height;
  Level coarse{width, height, std::vector<float>(count), std::vector<std::uint8_t>(count)};
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      double sum = 0.0;
      int known = 0;
      for (int y = 2 * r; y < std::min(2 * r + 2, fine.height); ++y) {
        for (int x = 2 * c; x < std::min(2 * c + 2, fine.width); ++x) {
          if (!fine.known[fine.index(x, y)]) continue;
          sum += fine.values[fine.index(x, y)];
          ++known;
        }
      }
      coarse.known[coarse.index(c, r)] = known > 0;
      if (known > 0) coarse.values[coarse.index(c, r)] = static_cast<float>(sum / known);
    }
  }
  return coarse;
}

/// Fills the unknown samples of `fine` bilinearly from its complete coarser level.
void prolongate(const Level& coarse, Level& fine) {
  for (int r = 0; r < fine.height; ++r) {
    for (int c = 0; c < fine.width; ++c) {
      if (fine.known[fine.index(c, r)]) continue;
      // A fine sample lies a quarter of a coarse cell from its parent's centre, towards the neighbour on its own side.
      const int c0 = c / 2, r0 = r / 2;
      const int c1 = std::clamp(c0 + (c % 2 == 0 ? -1 : 1), 0, coarse.width - 1);
      const int r1 = std::clamp(r0 + (r % 2 == 0 ? -1 : 1), 0, coarse.height - 1);
      const auto value = [&](int x, int y) { return static_cast<double>(coarse.values[coarse.index(x, y)]); };
      const double near = 0.75 * value(c0, r0) + 0.25 * value(c1, r0);
      const double far = 0.75 * value(c0, r1) + 0.25 * value(c1, r1);
      fine.values[fine.index(c, r)] = static_cast<float>(0.75 * near + 0.25 * far);
    }
  }
}

/// One Gauss-Seidel sweep of Laplace's equation over the unknown samples, forwards or backwards.
void sweep(Level& level, bool forwards) {
  const std::size_t count = level.values.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = forwards ? k : count - 1 - k;
    if (level.known[i]) continue;
    const int c = static_cast<int>(i % level.width), r = static_cast<int>(i / level.width);
    double sum = 0.0;
    int neighbours = 0;
    const auto add = [&](int x, int y) {
      if (x < 0 || y < 0 || x >= level.width || y >= level.height) return;
      sum += level.values[level.index(x, y)];
      ++neighbours;
    };
    add(c - 1, r), add(c + 1, r), add(c, r - 1), add(c, r + 1);
    if (neighbours > 0) level.values[i] = static_cast<float>(sum / neighbours);
  }
}

/// Metres from every sample to the nearest one whose NaN-ness is `nan`; infinite when there is none.
std::vector<double> distances(const ElevationGrid& grid, bool nan) {
  std::vector<char> marked(grid.elevations.size());
  for (std::size_t i = 0; i < marked.size(); ++i) marked[i] = std::isnan(grid.elevations[i]) == nan;
  return distance_to_marked(grid.width, grid.height, {grid.cell_x, grid.cell_y}, marked, kInfinity);
}

}  // namespace

std::vector<float> filled_elevations(const ElevationGrid& grid) {
  std::vector<Level> levels;
  levels.push_back({grid.width, grid.height, grid.elevations, std::vector<std::uint8_t>(grid.elevations.size())});
  for (std::size_t i = 0; i < grid.elevations.size(); ++i) levels[0].known[i] = !std::isnan(grid.elevations[i]);
  while (!levels.back().complete() && levels.back().values.size() > 1) levels.push_back(coarser(levels.back()));
  for (std::size_t i = levels.size() - 1; i-- > 0;) {
    prolongate(levels[i + 1], levels[i]);
    for (int s = 0; s < kSweeps; ++s) sweep(levels[i], s % 2 == 0);
  }
  return std::move(levels.front().values);
}

std::vector<float> hole_distances(const ElevationGrid& grid) {
  const std::vector<double> to_nan = distances(grid, true);
  const std::vector<double> to_data = distances(grid, false);
  const double half_step = 0.5 * std::min(grid.cell_x, grid.cell_y);
  const double farthest = grid.width * grid.cell_x + grid.height * grid.cell_y;  // Stands for infinity.
  std::vector<double> signed_distance(to_nan.size());
  for (std::size_t i = 0; i < to_nan.size(); ++i) {
    signed_distance[i] = to_nan[i] > 0.0 ? half_step - std::min(to_nan[i], farthest) : to_data[i] - half_step;
  }

  // The steepest bilinear cell: differences along x and y are largest on a cell's edges.
  double steepest2 = 1.0;
  const auto at = [&](int c, int r) { return signed_distance[static_cast<std::size_t>(r) * grid.width + c]; };
  for (int r = 0; r + 1 < grid.height; ++r) {
    for (int c = 0; c + 1 < grid.width; ++c) {
      const double dx =
          std::max(std::abs(at(c + 1, r) - at(c, r)), std::abs(at(c + 1, r + 1) - at(c, r + 1))) / grid.cell_x;
      const double dy =
          std::max(std::abs(at(c, r + 1) - at(c, r)), std::abs(at(c + 1, r + 1) - at(c + 1, r))) / grid.cell_y;
      steepest2 = std::max(steepest2, dx * dx + dy * dy);
    }
  }
  const double scale = (1.0 - 1e-6) / std::sqrt(steepest2);  // Room for rounding to float.
  std::vector<float> result(signed_distance.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = static_cast<float>(scale * signed_distance[i]);
  return result;
}

}  // namespace outcrop::terrain

#include "outcrop/terrain/distance_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "outcrop/core/parallel.h"

namespace outcrop {
namespace {

constexpr std::size_t kTogether = 64;  // Columns: a line of the cache or more in each row.
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// result[i] = min over j of (step · (i − j))² + squared[j].
std::vector<double> lower_envelope(const std::vector<double>& squared, double step) {
  std::vector<double> apex;        // Of the parabolas that are lowest somewhere, from left to right …
  std::vector<double> apex_value;
  std::vector<double> start;       // … and where they begin to be.
  for (std::size_t i = 0; i < squared.size(); ++i) {
    if (squared[i] == kInfinity) continue;
    const double x = step * static_cast<double>(i);
    double from = -kInfinity;
    while (!apex.empty()) {
      from = 0.5 * ((squared[i] - apex_value.back()) / (x - apex.back()) + x + apex.back());
      if (from > start.back()) break;
      apex.pop_back();
      apex_value.pop_back();
      start.pop_back();
      from = -kInfinity;
    }
    apex.push_back(x);
    apex_value.push_back(squared[i]);
    start.push_back(from);
  }
  std::vector<double> result(squared.size(), kInfinity);
  for (std::size_t i = 0, k = 0; i < squared.size() && !apex.empty(); ++i) {
    const double x = step * static_cast<double>(i);
    while (k + 1 < apex.size() && start[k + 1] < x) ++k;
    result[i] = (x - apex[k]) * (x - apex[k]) + apex_value[k];
  }
  return result;
}

}  // namespace

template <class Real>
std::vector<Real> distance_to_marked(int width, int height, const Vec2& cell, const std::vector<char>& marked, Real farthest) {
  std::vector<Real> distances(marked.size(), farthest);
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  const Real step = static_cast<Real>(cell.y);
  // Along a column two sweeps that count steps, from below and from above; columns side by side, as they lie in memory.
  parallel_for((columns + kTogether - 1) / kTogether, [&](std::size_t group) {
    const std::size_t first = group * kTogether, count = std::min(kTogether, columns - first);
    for (const bool upwards : {true, false}) {
      std::array<Real, kTogether> distance;
      distance.fill(farthest);
      for (std::size_t i = 0; i < rows; ++i) {
        const std::size_t at = (upwards ? i : rows - 1 - i) * columns + first;
        const char* const mark = &marked[at];
        Real* const nearest = &distances[at];
        for (std::size_t k = 0; k < count; ++k) {
          const Real next = distance[k] + step < farthest ? distance[k] + step : farthest;
          distance[k] = mark[k] != 0 ? Real{0} : next;
          nearest[k] = distance[k] < nearest[k] ? distance[k] : nearest[k];
        }
      }
    }
  });
  parallel_for(rows, [&](std::size_t row) {
    const auto first = distances.begin() + static_cast<std::ptrdiff_t>(row * columns), last = first + width;
    if (std::all_of(first, last, [&](Real d) { return d >= farthest; })) return;
    std::vector<double> squared(columns);
    std::transform(first, last, squared.begin(), [&](Real d) { return d < farthest ? double{d} * double{d} : kInfinity; });
    squared = lower_envelope(squared, cell.x);
    std::transform(squared.begin(), squared.end(), first,
                   [&](double s) { return std::min(static_cast<Real>(std::sqrt(s)), farthest); });
  });
  return distances;
}

template std::vector<float> distance_to_marked(int, int, const Vec2&, const std::vector<char>&, float);
template std::vector<double> distance_to_marked(int, int, const Vec2&, const std::vector<char>&, double);

}  // namespace outcrop

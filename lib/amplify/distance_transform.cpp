#include "distance_transform.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "outcrop/core/parallel.h"

namespace outcrop {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// result[i] = min over j of (i − j)² + squared[j].
std::vector<double> lower_envelope(const std::vector<double>& squared) {
  const int n = static_cast<int>(squared.size());
  std::vector<int> apex;      // Of the parabolas that are lowest somewhere, from left to right …
  std::vector<double> start;  // … and where they begin to be.
  for (int i = 0; i < n; ++i) {
    if (squared[i] == kInfinity) continue;
    double from = -kInfinity;
    while (!apex.empty()) {
      const int j = apex.back();
      from = 0.5 * ((squared[i] - squared[j]) / (i - j) + (i + j));
      if (from > start.back()) break;
      apex.pop_back();
      start.pop_back();
      from = -kInfinity;
    }
    apex.push_back(i);
    start.push_back(from);
  }
  std::vector<double> result(squared.size(), kInfinity);
  for (std::size_t i = 0, k = 0; i < squared.size() && !apex.empty(); ++i) {
    while (k + 1 < apex.size() && start[k + 1] < static_cast<double>(i)) ++k;
    const double d = static_cast<double>(i) - apex[k];
    result[i] = d * d + squared[apex[k]];
  }
  return result;
}

}  // namespace

std::vector<float> distance_to_marked(int width, int height, const std::vector<char>& marked, float farthest) {
  std::vector<float> distances(marked.size(), farthest);
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  // Along a column the distance is a count of nodes, from below and from above.
  parallel_for(columns, [&](std::size_t column) {
    for (const bool upwards : {true, false}) {
      float steps = farthest;
      for (std::size_t i = 0; i < rows; ++i) {
        const std::size_t at = (upwards ? i : rows - 1 - i) * columns + column;
        steps = marked[at] ? 0.0f : std::min(steps + 1.0f, farthest);
        distances[at] = std::min(distances[at], steps);
      }
    }
  });
  parallel_for(rows, [&](std::size_t row) {
    const auto first = distances.begin() + static_cast<std::ptrdiff_t>(row * columns), last = first + width;
    if (std::all_of(first, last, [&](float d) { return d >= farthest; })) return;
    std::vector<double> squared(columns);
    std::transform(first, last, squared.begin(), [&](float d) { return d < farthest ? double(d) * d : kInfinity; });
    squared = lower_envelope(squared);
    std::transform(squared.begin(), squared.end(), first,
                   [&](double s) { return std::min(static_cast<float>(std::sqrt(s)), farthest); });
  });
  return distances;
}

}  // namespace outcrop

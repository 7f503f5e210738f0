#include <algorithm>
#include <cmath>
#include <vector>

#include "outcrop/amplify/amplify.h"

namespace outcrop {
namespace {

constexpr int kLargestRaster = 1024;      // Probes a side: the search needs no more.
constexpr double kLargestSlope = 6.0;     // Steeper probes count no more than this: one spike is no cliff.
constexpr double kTile = 20.0;            // Metres, Paris et al. 2020, section 4.
constexpr double kTilesAcross = 4.0;      // A terrain smaller than this many tiles gets smaller tiles.

/// Sums over rectangles of a raster in constant time.
class SummedArea {
 public:
  SummedArea(int width, int height, const std::vector<double>& values)
      : width_(width), sums_(static_cast<std::size_t>(width + 1) * (height + 1), 0.0) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        at(x + 1, y + 1) = values[static_cast<std::size_t>(y) * width + x] + at(x, y + 1) + at(x + 1, y) - at(x, y);
  }
  [[nodiscard]] double sum(int x0, int y0, int x1, int y1) { return at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0); }

 private:
  double& at(int x, int y) { return sums_[static_cast<std::size_t>(y) * (width_ + 1) + x]; }
  int width_;
  std::vector<double> sums_;
};

}  // namespace

double default_tile_side(const Heightfield& heightfield) {
  const Vec2 extent = heightfield.hi() - heightfield.lo();
  return std::min(kTile, std::min(extent.x, extent.y) / kTilesAcross);
}

SteepWindow steepest_window(const Heightfield& heightfield, double size, double slope) {
  const Vec2 lo = heightfield.lo();
  const Vec2 extent = heightfield.hi() - lo;
  const double step = std::max({extent.x / kLargestRaster, extent.y / kLargestRaster,
                                std::min(heightfield.grid().cell_x, heightfield.grid().cell_y)});
  const int width = std::max(1, static_cast<int>(extent.x / step)), height = std::max(1, static_cast<int>(extent.y / step));
  const double threshold = std::tan(slope);
  std::vector<double> area(static_cast<std::size_t>(width) * height), valid(area.size());
  std::vector<Vec2> downhill(area.size());
  std::size_t steepest = 0;
  double steepest_slope = -1.0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      const Vec2 p = lo + step * Vec2(x + 0.5, y + 0.5);
      if (heightfield.has_holes() && heightfield.hole_distance(p.x, p.y) > -2.0 * step) continue;
      valid[i] = 1.0;
      const Heightfield::Sample s = heightfield.at(p.x, p.y);
      const double tangent = std::hypot(s.hx, s.hy);
      downhill[i] = -Vec2(s.hx, s.hy);
      if (tangent > steepest_slope) steepest_slope = tangent, steepest = i;
      // The area of the wall over this probe, so that high cliffs win over patches of steep ground.
      if (tangent >= threshold) area[i] = std::hypot(1.0, std::min(tangent, kLargestSlope));
    }

  const int w = std::clamp(static_cast<int>(std::lround(size / step)), 1, width);
  const int h = std::clamp(static_cast<int>(std::lround(size / step)), 1, height);
  SummedArea areas(width, height, area), valids(width, height, valid);
  int best_x = std::clamp(static_cast<int>(steepest) % width - w / 2, 0, width - w);
  int best_y = std::clamp(static_cast<int>(steepest) / width - h / 2, 0, height - h);
  double best = 0.0;
  for (int y = 0; y + h <= height; ++y)
    for (int x = 0; x + w <= width; ++x) {
      // Windows that hang over missing data lose in proportion.
      const double score = areas.sum(x, y, x + w, y + h) * valids.sum(x, y, x + w, y + h);
      if (score > best) best = score, best_x = x, best_y = y;
    }

  SteepWindow window{.lo = lo + step * Vec2(best_x, best_y), .hi = {}, .focus = {}, .downhill = Vec2(0.0, -1.0), .share = 0.0};
  window.hi = glm::min(window.lo + step * Vec2(w, h), heightfield.hi());
  Vec2 centroid(0.0), fall(0.0);
  double total = 0.0, steep_count = 0.0;
  for (int y = best_y; y < best_y + h; ++y)
    for (int x = best_x; x < best_x + w; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      total += area[i];
      steep_count += area[i] > 0.0;
      centroid += area[i] * Vec2(x, y);
      fall += area[i] * downhill[i] / std::max(glm::length(downhill[i]), 1e-9);
    }
  if (total > 0.0) {
    centroid /= total;
    window.share = steep_count / (static_cast<double>(w) * h);
  } else {
    centroid = Vec2(static_cast<double>(steepest % width), static_cast<double>(steepest / width));
    fall = downhill[steepest];
  }
  if (glm::length(fall) > 1e-9) window.downhill = glm::normalize(fall);
  // The steep probe nearest to the centroid: the centroid itself may hang over a valley.
  double nearest = std::numeric_limits<double>::infinity();
  Vec2 focus = centroid;
  for (int y = best_y; y < best_y + h; ++y)
    for (int x = best_x; x < best_x + w; ++x) {
      if (total > 0.0 && area[static_cast<std::size_t>(y) * width + x] <= 0.0) continue;
      const double distance = glm::length(Vec2(x, y) - centroid);
      if (distance < nearest) nearest = distance, focus = Vec2(x, y);
    }
  const Vec2 p = lo + step * (focus + 0.5);
  window.focus = Vec3(p, heightfield.at(p.x, p.y).h);
  return window;
}

}  // namespace outcrop

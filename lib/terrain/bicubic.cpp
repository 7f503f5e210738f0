#include "bicubic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "outcrop/core/parallel.h"

namespace outcrop::terrain {
namespace {

constexpr double kMonotoneLimit = 3.0;    // Fritsch and Carlson 1980: slopes up to three times the smaller step.
constexpr double kRoundingSlack = 1e-12;  // Relative; evaluation in doubles errs by some 1e-15 of the largest term.

/// The slope at a sample between the steps `before` and `after`.
double limited_slope(double before, double after) noexcept {
  const double smaller = std::min(std::abs(before), std::abs(after));
  const double limit = before * after > 0.0 ? kMonotoneLimit * smaller : smaller;
  return std::clamp(0.5 * (before + after), -limit, limit);
}

/// Slopes along one line of samples; at its ends the slope is the only step there is.
template <class Value>
double line_slope(int i, int count, Value&& value) {
  if (i == 0) return value(1) - value(0);
  if (i == count - 1) return value(i) - value(i - 1);
  return limited_slope(value(i) - value(i - 1), value(i + 1) - value(i));
}

double minmod(double a, double b) noexcept {
  if (a * b <= 0.0) return 0.0;
  return std::abs(a) < std::abs(b) ? a : b;
}

/// The cubic Hermite basis on [0, 1] and its derivatives; the basis function of the left value is 1 − `right`.
struct Hermite {
  double right, left_slope, right_slope;
  double d_right, d_left_slope, d_right_slope;

  explicit Hermite(double t) noexcept
      : right(t * t * (3.0 - 2.0 * t)),
        left_slope(t * (1.0 - t) * (1.0 - t)),
        right_slope(-t * t * (1.0 - t)),
        d_right(6.0 * t * (1.0 - t)),
        d_left_slope((1.0 - t) * (1.0 - 3.0 * t)),
        d_right_slope(t * (3.0 * t - 2.0)) {}

  [[nodiscard]] double value(double a, double b, double da, double db) const noexcept {
    return a + (right * (b - a) + left_slope * da + right_slope * db);
  }
  [[nodiscard]] double derivative(double a, double b, double da, double db) const noexcept {
    return d_right * (b - a) + d_left_slope * da + d_right_slope * db;
  }
};

using Net = std::array<std::array<double, 4>, 4>;  // [row][column] of Bézier control points.

Net control_points(const Patch& p) noexcept {
  // Hermite to Bézier along one edge: a, a + da/3, b − db/3, b; first along the rows, for values and row slopes alike.
  const auto edge = [](double a, double b, double da, double db) {
    return std::array<double, 4>{a, a + da / 3.0, b - db / 3.0, b};
  };
  const auto north = edge(p.nw.h, p.ne.h, p.nw.hx, p.ne.hx);
  const auto south = edge(p.sw.h, p.se.h, p.sw.hx, p.se.hx);
  const auto north_slope = edge(p.nw.hy, p.ne.hy, p.nw.hxy, p.ne.hxy);
  const auto south_slope = edge(p.sw.hy, p.se.hy, p.sw.hxy, p.se.hxy);
  Net net;
  for (int c = 0; c < 4; ++c) {
    const auto column = edge(north[c], south[c], north_slope[c], south_slope[c]);
    for (int r = 0; r < 4; ++r) net[r][c] = column[r];
  }
  return net;
}

/// Derivative of a cubic Bézier curve as a quadratic one, raised again to degree 3 (same curve, four points), so that
/// both partial derivatives have points on the same net and |∇h| is bounded by the longest pair.
std::array<double, 4> derivative_cubic(double a, double b, double c, double d) noexcept {
  const double q0 = 3.0 * (b - a), q1 = 3.0 * (c - b), q2 = 3.0 * (d - c);
  return {q0, (q0 + 2.0 * q1) / 3.0, (2.0 * q1 + q2) / 3.0, q2};
}

float below(double v) noexcept {
  return std::nextafter(static_cast<float>(v), -std::numeric_limits<float>::infinity());
}
float above(double v) noexcept { return std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity()); }

PatchBound outward(double lo, double hi, double slope, double curvature, double magnitude, const Vec2& cell) noexcept {
  const double slack = kRoundingSlack * magnitude;
  return {below(lo - slack), above(hi + slack), above(slope + slack / std::min(cell.x, cell.y)), above(curvature)};
}

}  // namespace

std::vector<Node> flat_nodes(const ElevationGrid& grid) {
  std::vector<Node> nodes(grid.elevations.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = {grid.elevations[i], 0.0f, 0.0f, 0.0f};
  return nodes;
}

std::vector<Node> hermite_nodes(const ElevationGrid& grid) {
  std::vector<Node> nodes = flat_nodes(grid);
  const auto node = [&](int c, int r) -> Node& { return nodes[static_cast<std::size_t>(r) * grid.width + c]; };
  const auto each_node = [&](auto&& body) {
    parallel_for(static_cast<std::size_t>(grid.height), [&](std::size_t row) {
      for (int c = 0; c < grid.width; ++c) body(c, static_cast<int>(row));
    });
  };
  each_node([&](int c, int r) {
    node(c, r).hx =
        static_cast<float>(line_slope(c, grid.width, [&](int i) { return static_cast<double>(grid.at(i, r)); }));
    node(c, r).hy =
        static_cast<float>(line_slope(r, grid.height, [&](int i) { return static_cast<double>(grid.at(c, i)); }));
  });
  // The twist is ∂y of hx and ∂x of hy; where the two limited estimates disagree the calmer one is taken.
  each_node([&](int c, int r) {
    const double of_hx = line_slope(r, grid.height, [&](int i) { return static_cast<double>(node(c, i).hx); });
    const double of_hy = line_slope(c, grid.width, [&](int i) { return static_cast<double>(node(i, r).hy); });
    node(c, r).hxy = static_cast<float>(minmod(of_hx, of_hy));
  });
  return nodes;
}

PatchSample evaluate_bicubic(const Patch& p, double u, double v) noexcept {
  const Hermite x(u), y(v);
  const double north = x.value(p.nw.h, p.ne.h, p.nw.hx, p.ne.hx);
  const double south = x.value(p.sw.h, p.se.h, p.sw.hx, p.se.hx);
  const double north_y = x.value(p.nw.hy, p.ne.hy, p.nw.hxy, p.ne.hxy);
  const double south_y = x.value(p.sw.hy, p.se.hy, p.sw.hxy, p.se.hxy);
  const double north_x = x.derivative(p.nw.h, p.ne.h, p.nw.hx, p.ne.hx);
  const double south_x = x.derivative(p.sw.h, p.se.h, p.sw.hx, p.se.hx);
  const double north_xy = x.derivative(p.nw.hy, p.ne.hy, p.nw.hxy, p.ne.hxy);
  const double south_xy = x.derivative(p.sw.hy, p.se.hy, p.sw.hxy, p.se.hxy);
  return {y.value(north, south, north_y, south_y), y.value(north_x, south_x, north_xy, south_xy),
          y.derivative(north, south, north_y, south_y)};
}

double bicubic_value(const Patch& p, double u, double v) noexcept {
  const Hermite x(u), y(v);
  return y.value(x.value(p.nw.h, p.ne.h, p.nw.hx, p.ne.hx), x.value(p.sw.h, p.se.h, p.sw.hx, p.se.hx),
                 x.value(p.nw.hy, p.ne.hy, p.nw.hxy, p.ne.hxy), x.value(p.sw.hy, p.se.hy, p.sw.hxy, p.se.hxy));
}

PatchSample evaluate_bilinear(const Patch& p, double u, double v) noexcept {
  const double nw = p.nw.h, ne = p.ne.h, sw = p.sw.h, se = p.se.h;
  const double north = nw + u * (ne - nw);
  const double south = sw + u * (se - sw);
  return {north + v * (south - north), (1.0 - v) * (ne - nw) + v * (se - sw), south - north};
}

PatchBound bound_bicubic(const Patch& patch, const Vec2& cell) noexcept {
  const Net net = control_points(patch);
  Interval h;
  double magnitude = 0.0;
  for (const auto& row : net) {
    for (const double v : row) {
      h.include(v);
      magnitude = std::max(magnitude, std::abs(v));
    }
  }
  Net dx, dy;
  for (int i = 0; i < 4; ++i) {
    dx[i] = derivative_cubic(net[i][0], net[i][1], net[i][2], net[i][3]);
    const auto column = derivative_cubic(net[0][i], net[1][i], net[2][i], net[3][i]);
    for (int r = 0; r < 4; ++r) dy[r][i] = column[r];
  }
  double slope2 = 0.0;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) {
      const double sx = dx[r][c] / cell.x, sy = dy[r][c] / cell.y;
      slope2 = std::max(slope2, sx * sx + sy * sy);
    }
  }
  // Second derivatives: differences of the nets of the first ones; Frobenius norm ≥ spectral norm. hxx comes from the
  // quadratic's two differences, which the raised net shows as 3 (d1 − d0) and 3 (d3 − d2).
  double xx = 0.0, yy = 0.0, xy = 0.0;
  for (int i = 0; i < 4; ++i) {
    xx = std::max({xx, std::abs(dx[i][1] - dx[i][0]), std::abs(dx[i][3] - dx[i][2])});
    yy = std::max({yy, std::abs(dy[1][i] - dy[0][i]), std::abs(dy[3][i] - dy[2][i])});
    for (int r = 0; r < 3; ++r) xy = std::max(xy, std::abs(dx[r + 1][i] - dx[r][i]));
  }
  xx *= 3.0 / (cell.x * cell.x);
  yy *= 3.0 / (cell.y * cell.y);
  xy *= 3.0 / (cell.x * cell.y);
  return outward(h.lo, h.hi, std::sqrt(slope2), std::sqrt(xx * xx + 2.0 * xy * xy + yy * yy), magnitude, cell);
}

PatchBound bound_bilinear(const Patch& p, const Vec2& cell) noexcept {
  const double nw = p.nw.h, ne = p.ne.h, sw = p.sw.h, se = p.se.h;
  const double sx = std::max(std::abs(ne - nw), std::abs(se - sw)) / cell.x;
  const double sy = std::max(std::abs(sw - nw), std::abs(se - ne)) / cell.y;
  const double lo = std::min({nw, ne, sw, se}), hi = std::max({nw, ne, sw, se});
  return outward(lo, hi, std::sqrt(sx * sx + sy * sy), std::numeric_limits<double>::infinity(),
                 std::max(std::abs(lo), std::abs(hi)), cell);
}

}  // namespace outcrop::terrain

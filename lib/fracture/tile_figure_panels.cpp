#include "tile_figure_panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "outcrop/fracture/rock_formulas.h"

namespace outcrop {
namespace {

constexpr std::string_view kInk = "#222222";
constexpr std::string_view kFaint = "#c8c8c8";
constexpr std::string_view kNumber = "#0072b2";  // Of curves: by number,
constexpr std::string_view kVolume = "#d55e00";  // and by volume.
constexpr std::size_t kMostPoles = 1500;

/// A plot's area with its axes' ranges.
struct Plot {
  Vec2 corner, size;
  Vec2 lo, hi;  // Values; logarithms where an axis is logarithmic.

  [[nodiscard]] Vec2 at(double x, double y) const {
    return corner + Vec2((x - lo.x) / (hi.x - lo.x) * size.x, (1.0 - (y - lo.y) / (hi.y - lo.y)) * size.y);
  }
};

void draw_box(Svg& svg, const Plot& plot) { svg.rect(plot.corner, plot.size, {.stroke = kInk, .width = 1.0}); }

// Lower hemisphere, equal area: the pole of a plane that dips by δ lies √2 sin(δ/2) radii from the centre, opposite to
// its dip direction.
Vec2 projected(const Vec3& normal) {
  const Orientation o = orientation_of(normal);
  const double r = std::sqrt(2.0) * std::sin(0.5 * o.dip);
  return {-r * std::sin(o.dip_direction), r * std::cos(o.dip_direction)};  // y down
}

// The great circle of a plane: where its lines leave the lower hemisphere.
std::vector<Vec2> great_circle(const Vec3& normal) {
  const Orientation o = orientation_of(normal);
  const Vec3 strike(std::cos(o.dip_direction), -std::sin(o.dip_direction), 0.0);
  const Vec3 down = glm::cross(normal_of(o), strike);
  const Vec3 fall = down.z > 0.0 ? -down : down;
  std::vector<Vec2> points;
  for (int i = 0; i <= 60; ++i) {
    const double t = kPi * i / 60.0;
    const Vec3 p = std::cos(t) * strike + std::sin(t) * fall;
    const double r = std::sqrt(std::max(0.0, 1.0 + p.z));  // √2 sin of half the angle from straight down
    const double level = std::hypot(p.x, p.y);
    points.push_back(level > 0.0 ? Vec2(r / level * p.x, -r / level * p.y) : Vec2(0.0));
  }
  return points;
}

// Poles with what they weigh: one a disc, the largest faces where there are no discs.
struct Pole {
  Vec3 normal;
  double area;
  int set;
};

std::vector<Pole> poles_of(const Tile& tile, const RockCells& rock) {
  std::vector<double> areas(tile.discs.size(), 0.0);
  std::vector<Pole> poles;
  for (const RockCells::Cell& cell : rock.cells())
    for (const Polytope::Face& face : cell.shape.faces) {
      if (face.joint == kWall) continue;
      const FaceMeasure m = measure(cell.shape, face);
      if (face.joint >= 0)
        areas[static_cast<std::size_t>(face.joint)] += 0.5 * m.area;
      else
        poles.push_back({m.normal, 0.5 * m.area, face.joint});
    }
  for (std::size_t i = 0; i < areas.size(); ++i)
    if (areas[i] > 0.0) poles.push_back({tile.discs[i].normal, areas[i], tile.discs[i].set});
  std::stable_sort(poles.begin(), poles.end(), [](const Pole& a, const Pole& b) { return a.area > b.area; });
  if (poles.size() > kMostPoles) poles.resize(kMostPoles);
  return poles;
}

// Decades of a logarithmic axis, with 2 and 5 where there is room.
std::vector<double> log_ticks(double lo, double hi) {
  std::vector<double> ticks;
  const bool is_wide = hi - lo > 3.0;
  for (int decade = static_cast<int>(std::floor(lo)) - 1; decade <= static_cast<int>(std::ceil(hi)); ++decade)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double v = std::log10(digit) + decade;
      if (v >= lo - 1e-9 && v <= hi + 1e-9 && (digit == 1.0 || !is_wide)) ticks.push_back(v);
    }
  return ticks;
}

void draw_curve(Svg& svg, const Plot& plot, const std::vector<std::pair<double, double>>& sorted,
                std::string_view colour) {
  double total = 0.0;
  for (const auto& [volume, weight] : sorted) total += weight;
  std::vector<Vec2> points{plot.at(plot.lo.x, 0.0)};
  double sum = 0.0;
  for (const auto& [volume, weight] : sorted) {
    const double x = std::log10(volume);
    points.push_back(plot.at(x, 100.0 * sum / total));
    sum += weight;
    points.push_back(plot.at(x, 100.0 * sum / total));
  }
  points.push_back(plot.at(plot.hi.x, 100.0));
  svg.polyline(points, {.stroke = colour, .width = 1.8});
}

}  // namespace

std::string_view set_colour(int set) {
  // Okabe and Ito's palette: told apart by colour-blind eyes.
  constexpr std::array<std::string_view, 6> kSets{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};
  if (set >= 0) return kSets[static_cast<std::size_t>(set) % kSets.size()];
  if (set == kColumnJoint) return "#e69f00";
  return set == kAddedJoint ? "#999999" : "#666666";
}

void draw_stereonet(Svg& svg, const Frame& frame, const Tile& tile, const RockCells& rock, const TileReport& report) {
  const double radius = 0.5 * std::min(frame.size.x - 150.0, frame.size.y - 40.0);
  const Vec2 centre = frame.corner + Vec2(radius + 14.0, radius + 20.0);
  svg.circle(centre, radius, {.fill = "#fcfcfc", .stroke = kInk, .width = 1.2});
  for (const double dip : {30.0, 60.0})
    svg.circle(centre, radius * std::sqrt(2.0) * std::sin(radians(0.5 * dip)), {.stroke = kFaint, .width = 0.7});
  svg.line(centre - Vec2(radius, 0), centre + Vec2(radius, 0), {.stroke = kFaint, .width = 0.7});
  svg.line(centre - Vec2(0, radius), centre + Vec2(0, radius), {.stroke = kFaint, .width = 0.7});
  for (const auto& [label, at] : {std::pair{"N", Vec2(0, -1)}, std::pair{"E", Vec2(1, 0)}, std::pair{"S", Vec2(0, 1)},
                                  std::pair{"W", Vec2(-1, 0)}})
    svg.text(centre + (radius + 9.0) * at + Vec2(0, 4), label, {.size = 11, .anchor = "middle"});
  const std::vector<Pole> poles = poles_of(tile, rock);
  const double largest = poles.empty() ? 1.0 : poles[0].area;
  for (const Pole& pole : poles)
    svg.circle(centre + radius * projected(report.map_from_tile * pole.normal),
               1.5 + 3.5 * std::sqrt(pole.area / largest),
               {.fill = set_colour(pole.set), .stroke = "#ffffff", .width = 0.4, .opacity = 0.75});
  double y = frame.corner.y + 26.0;
  const double x = centre.x + radius + 28.0;
  const auto entry = [&](std::string_view colour, const std::string& first, const std::string& second) {
    svg.circle({x, y - 4.0}, 4.5, {.fill = colour});
    svg.text({x + 10.0, y}, first, {.size = 11, .bold = true});
    if (!second.empty()) svg.text({x + 10.0, y += 14.0}, second, {.size = 11});
    y += 20.0;
  };
  for (const SetStatistics& set : report.statistics.sets) {
    if (set.p32 == 0.0) continue;
    const bool has_mean = set.set >= 0 && set.joints + set.spacings > 0;
    const std::string colour(set_colour(set.set));
    std::string where;
    if (has_mean) {
      const Vec2 at = centre + radius * projected(set.orientation.mean);
      for (const Vec2& d : {Vec2(5, 5), Vec2(5, -5)}) {
        svg.line(at - d, at + d, {.stroke = "#ffffff", .width = 4.0});
        svg.line(at - d, at + d, {.stroke = kInk, .width = 2.0});
      }
      std::vector<Vec2> circle = great_circle(set.orientation.mean);
      for (Vec2& p : circle) p = centre + radius * p;
      svg.polyline(circle, {.stroke = colour, .width = 1.2, .dash = "5 3"});
      const Orientation mean = orientation_of(set.orientation.mean);
      char text[48];
      std::snprintf(text, sizeof text, "%02.0f/%03.0f, κ %s", degrees(mean.dip), degrees(mean.dip_direction),
                    set.orientation.kappa > 1e4 ? "> 10⁴" : short_number(set.orientation.kappa, 2).c_str());
      where = text;
    }
    entry(colour, set.name, where);
  }
  svg.text({frame.corner.x + 14.0, centre.y + radius + 32.0},
           "Poles by area, × mean and its plane; equal area, lower hemisphere", {.size = 10.5, .fill = "#555"});
}

void draw_volumes(Svg& svg, const Frame& frame, const RockStatistics& rock) {
  std::vector<std::pair<double, double>> by_number;
  std::vector<std::pair<double, double>> by_volume;
  for (const BlockMeasure& block : rock.blocks) {
    by_number.emplace_back(block.volume, 1.0);
    by_volume.emplace_back(block.volume, block.volume);
  }
  std::sort(by_number.begin(), by_number.end());
  std::sort(by_volume.begin(), by_volume.end());
  const double lo = std::log10(by_number.front().first) - 0.08;
  const double hi = std::log10(by_number.back().first) + 0.08;
  const Plot plot{frame.corner + Vec2(42, 6), frame.size - Vec2(52, 50), {lo, 0.0}, {hi, 100.0}};
  for (const double tick : log_ticks(lo, hi)) {
    svg.line(plot.at(tick, 0), plot.at(tick, 100), {.stroke = kFaint, .width = 0.6});
    svg.text(plot.at(tick, 0) + Vec2(0, 14), short_number(std::pow(10.0, tick), 2), {.size = 10.5, .anchor = "middle"});
  }
  for (const double share : {0.0, 10.0, 25.0, 50.0, 75.0, 90.0, 100.0}) {
    svg.line(plot.at(lo, share), plot.at(hi, share), {.stroke = kFaint, .width = 0.6});
    svg.text(plot.at(lo, share) + Vec2(-5, 4), short_number(share), {.size = 10.5, .anchor = "end"});
  }
  draw_curve(svg, plot, by_number, kNumber);
  draw_curve(svg, plot, by_volume, kVolume);
  const auto mark = [&](const Quantiles& q, std::string_view colour) {
    for (const auto& [share, volume] : {std::pair{10.0, q.d10}, std::pair{50.0, q.d50}, std::pair{90.0, q.d90}})
      svg.circle(plot.at(std::clamp(std::log10(volume), lo, hi), share), 3.4,
                 {.fill = "#fff", .stroke = colour, .width = 1.6});
  };
  mark(rock.volume_by_number, kNumber);
  mark(rock.volume_by_volume, kVolume);
  draw_box(svg, plot);
  svg.text(plot.corner + Vec2(8, 16), "by number", {.size = 11, .fill = kNumber, .bold = true});
  svg.text(plot.corner + Vec2(8, 31), "by volume", {.size = 11, .fill = kVolume, .bold = true});
  svg.text(plot.corner + Vec2(0.5 * plot.size.x, plot.size.y + 32), "block volume, m³",
           {.size = 11, .anchor = "middle"});
  svg.text(frame.corner + Vec2(9, 6 + 0.5 * plot.size.y), "% smaller",
           {.size = 11, .anchor = "middle", .turn_deg = -90});
}

void draw_shapes(Svg& svg, const Frame& frame, const RockStatistics& rock) {
  double most = 4.0;
  for (const BlockMeasure& block : rock.blocks) most = std::max({most, block.elongation(), block.flatness()});
  const double end = std::log10(std::min(most, 30.0)) + 0.03;
  const Plot plot{frame.corner + Vec2(42, 6), frame.size - Vec2(52, 50), {0.0, 0.0}, {end, end}};
  for (const double tick : log_ticks(0.0, end)) {
    const std::string label = short_number(std::pow(10.0, tick), 2);
    svg.text(plot.at(tick, 0) + Vec2(0, 14), label, {.size = 10.5, .anchor = "middle"});
    svg.text(plot.at(0, tick) + Vec2(-5, 4), label, {.size = 10.5, .anchor = "end"});
  }
  // β of a block with edges 1, f, f e: along each curve it is the same.
  for (const double beta : {28.0, 33.0, 60.0, 200.0}) {
    std::vector<Vec2> curve;
    for (int i = 0; i <= 80; ++i) {
      const double y = end * i / 80.0;
      const double f = std::pow(10.0, y);
      if (block_shape_factor({1.0, f, f}) > beta) break;
      double a = 0.0;
      double b = 3.0;
      for (int step = 0; step < 40; ++step) {
        const double m = 0.5 * (a + b);
        (block_shape_factor({1.0, f, f * std::pow(10.0, m)}) < beta ? a : b) = m;
      }
      if (a <= end) curve.push_back(plot.at(a, y));
    }
    if (curve.size() < 2) continue;
    svg.polyline(curve, {.stroke = "#999999", .width = 0.8, .dash = "2 3"});
    const bool is_at_top = curve.back().y < plot.corner.y + 30.0;
    svg.text(curve.back() + (is_at_top ? Vec2(4, 28) : Vec2(3, -3)), "β " + short_number(beta),
             {.size = 9.5, .fill = "#777"});
  }
  const double two = std::log10(2.0);
  svg.line(plot.at(two, 0), plot.at(two, end), {.stroke = kInk, .width = 0.8});
  svg.line(plot.at(0, two), plot.at(end, two), {.stroke = kInk, .width = 0.8});
  double greatest = 0.0;
  std::array<int, 4> counts{};
  for (const BlockMeasure& block : rock.blocks) {
    greatest = std::max(greatest, block.volume);
    ++counts[static_cast<std::size_t>((block.elongation() >= 2.0) + 2 * (block.flatness() >= 2.0))];
  }
  for (const BlockMeasure& block : rock.blocks)
    svg.circle(plot.at(std::min(std::log10(block.elongation()), end), std::min(std::log10(block.flatness()), end)),
               1.2 + 4.0 * std::cbrt(block.volume / greatest), {.fill = kNumber, .opacity = 0.45});
  const auto share = [&](std::size_t k, const char* word) {
    return std::string(word) + " " + short_number(100.0 * counts[k] / static_cast<double>(rock.blocks.size()), 2) +
           " %";
  };
  svg.text(plot.at(0, 0) + Vec2(5, -6), share(0, "blocky"), {.size = 11, .bold = true});
  svg.text(plot.at(end, 0) + Vec2(-5, -6), share(1, "columnar"), {.size = 11, .anchor = "end", .bold = true});
  svg.text(plot.at(0, end) + Vec2(5, 14), share(2, "tabular"), {.size = 11, .bold = true});
  svg.text(plot.at(end, end) + Vec2(-5, 14), share(3, "both"), {.size = 11, .anchor = "end", .bold = true});
  draw_box(svg, plot);
  svg.text(plot.corner + Vec2(0.5 * plot.size.x, plot.size.y + 32), "elongation, longest / middle",
           {.size = 11, .anchor = "middle"});
  svg.text(frame.corner + Vec2(9, 6 + 0.5 * plot.size.y), "flatness, middle / shortest",
           {.size = 11, .anchor = "middle", .turn_deg = -90});
}

void draw_traces(Svg& svg, const Frame& frame, const Tile& tile, const RockCells& rock, const Mat3& map_from_tile) {
  const double size = std::min(frame.size.x - 10.0, frame.size.y - 44.0);
  const Vec2 corner = frame.corner + Vec2(0.5 * (frame.size.x - size), 6.0);
  const CutPlane cut{.origin = Vec3(0, 0, 0.5 * tile.side), .width = tile.side, .height = tile.side};
  const std::vector<Trace> traces = trace_map(tile, rock, cut);
  const double scale = size / tile.side;
  for (const Trace& trace : traces) {
    const auto flat = [&](const Vec2& p) { return corner + Vec2(scale * p.x, size - scale * p.y); };
    svg.line(flat(trace.a), flat(trace.b), {.stroke = set_colour(trace.set), .width = 1.4});
  }
  svg.rect(corner, Vec2(size), {.stroke = kInk, .width = 1.0});
  svg.text(corner + Vec2(0.5 * size, size + 16.0),
           short_number(tile.side) + " m wide; P21 " + short_number(intensity_p21(traces, cut)) + " 1/m",
           {.size = 11, .anchor = "middle"});
  const Vec3 north = glm::transpose(map_from_tile) * Vec3(0, 1, 0);
  const Vec2 foot = corner + Vec2(size - 14.0, size + 34.0);
  const Vec2 tip = foot + 18.0 * Vec2(north.x, -north.y);
  svg.line(foot, tip, {.stroke = kInk, .width = 1.3});
  svg.text(tip + 6.0 * Vec2(north.x, -north.y) + Vec2(0, 4), "N", {.size = 10, .anchor = "middle"});
}

}  // namespace outcrop

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tile_figure_panels.h"

namespace outcrop {
namespace {

constexpr double kAzimuth = radians(150.0);  // Where the viewer stands, clockwise from north.
constexpr double kHeight = radians(28.0);    // Above the horizon.
constexpr std::size_t kMostSorted = 1500;    // Blocks; more are drawn in the order of their depth.
constexpr double kShell = 3.0;               // Mean block sizes: blocks deeper in the tile are hidden.

/// A block as it is drawn.
struct Solid {
  Polytope shape;
  Vec2 lo{1e300}, hi{-1e300};  // On the picture's plane.
  double depth = 0.0;          // Towards the viewer.
};

struct View {
  Vec3 to_viewer, right, up;

  View() {
    to_viewer = {std::cos(kHeight) * std::sin(kAzimuth), std::cos(kHeight) * std::cos(kAzimuth), std::sin(kHeight)};
    right = glm::normalize(glm::cross(Vec3(0, 0, 1), to_viewer));
    up = glm::cross(to_viewer, right);
  }
  [[nodiscard]] Vec2 flat(const Vec3& p) const { return {glm::dot(p, right), -glm::dot(p, up)}; }
};

Polytope shape_of(const Block& block) {
  Polytope shape = box_polytope(block.bounds.grown(1e-3 * glm::length(block.bounds.size())));
  for (std::size_t i = 0; i < block.planes.size(); ++i)
    shape = clipped(shape, block.planes[i], block.plane_joint[i], 1e-9 * glm::length(block.bounds.size()));
  for (Vec3& v : shape.vertices) v += block.centre;
  for (Polytope::Face& face : shape.faces) face.plane.offset -= glm::dot(face.plane.normal, block.centre);
  return shape;
}

// Whether a must be drawn before b: a face of either parts them, and b lies on the viewer's side of it.
bool is_behind(const Solid& a, const Solid& b, const View& view) {
  constexpr double kSlack = 1e-6;
  if (a.hi.x <= b.lo.x || b.hi.x <= a.lo.x || a.hi.y <= b.lo.y || b.hi.y <= a.lo.y) return false;
  for (const Polytope::Face& face : a.shape.faces)
    if (b.shape.distances(face.plane).lo >= -kSlack) return glm::dot(face.plane.normal, view.to_viewer) > 0.0;
  for (const Polytope::Face& face : b.shape.faces)
    if (a.shape.distances(face.plane).lo >= -kSlack) return glm::dot(face.plane.normal, view.to_viewer) < 0.0;
  return a.depth < b.depth;
}

// Farthest first, so that each block covers those behind it. Where blocks lie in a ring, the deepest goes first.
std::vector<std::size_t> painters_order(const std::vector<Solid>& solids, const View& view) {
  std::vector<std::size_t> by_depth(solids.size());
  for (std::size_t i = 0; i < solids.size(); ++i) by_depth[i] = i;
  std::stable_sort(by_depth.begin(), by_depth.end(),
                   [&](std::size_t a, std::size_t b) { return solids[a].depth < solids[b].depth; });
  if (solids.size() > kMostSorted) return by_depth;
  std::vector<std::vector<std::size_t>> behind(solids.size());
  for (std::size_t a = 0; a < solids.size(); ++a)
    for (std::size_t b = 0; b < solids.size(); ++b)
      if (a != b && is_behind(solids[b], solids[a], view)) behind[a].push_back(b);
  std::vector<std::size_t> order;
  std::vector<bool> is_drawn(solids.size(), false);
  while (order.size() < solids.size()) {
    const std::size_t before = order.size();
    for (const std::size_t i : by_depth) {
      if (is_drawn[i] || !std::all_of(behind[i].begin(), behind[i].end(), [&](std::size_t b) { return is_drawn[b]; }))
        continue;
      is_drawn[i] = true;
      order.push_back(i);
    }
    if (order.size() > before) continue;
    const auto next = std::find_if(by_depth.begin(), by_depth.end(), [&](std::size_t i) { return !is_drawn[i]; });
    is_drawn[*next] = true;
    order.push_back(*next);
  }
  return order;
}

// The set's colour, pale, as a face looks that turns to the light, and of a tone of its block's own.
std::string shaded(std::string_view colour, double light, double tone) {
  unsigned rgb[3];
  std::sscanf(std::string(colour).c_str(), "#%2x%2x%2x", &rgb[0], &rgb[1], &rgb[2]);
  char text[8];
  int shown[3];
  for (int c = 0; c < 3; ++c) {
    const double pale = 0.5 * rgb[c] + 0.5 * 240.0;
    shown[c] = static_cast<int>(std::clamp(pale * (0.58 + 0.46 * light) * tone, 0.0, 255.0));
  }
  std::snprintf(text, sizeof text, "#%02x%02x%02x", shown[0], shown[1], shown[2]);
  return text;
}

}  // namespace

void draw_blocks(Svg& svg, const Frame& frame, const Tile& tile, const Mat3& map_from_tile) {
  const View view;
  const double deep = kShell * std::cbrt(std::pow(tile.side, 3.0) / static_cast<double>(tile.blocks.size()));
  std::vector<Solid> solids;
  std::vector<std::size_t> numbers;
  Vec2 lo(1e300);
  Vec2 hi(-1e300);
  for (std::size_t i = 0; i < tile.blocks.size(); ++i) {
    const Block& block = tile.blocks[i];
    double to_side = 1e300;  // that the viewer sees
    for (int axis = 0; axis < 3; ++axis)
      to_side = std::min(to_side, view.to_viewer[axis] > 0.0 ? tile.side - block.centre[axis] - block.bounds.hi[axis]
                                                             : block.centre[axis] + block.bounds.lo[axis]);
    if (to_side > deep) continue;
    Solid solid{.shape = shape_of(block)};
    for (const Vec3& v : solid.shape.vertices) {
      solid.lo = glm::min(solid.lo, view.flat(v));
      solid.hi = glm::max(solid.hi, view.flat(v));
    }
    solid.depth = glm::dot(block.centre, view.to_viewer);
    lo = glm::min(lo, solid.lo);
    hi = glm::max(hi, solid.hi);
    solids.push_back(std::move(solid));
    numbers.push_back(i);
  }
  const Vec2 room = frame.size - Vec2(0.0, 34.0);
  const double scale = std::min(room.x / (hi.x - lo.x), room.y / (hi.y - lo.y));
  const Vec2 shift = frame.corner + 0.5 * (room - scale * (lo + hi));
  const Vec3 sun = glm::normalize(0.9 * view.right + 0.9 * view.to_viewer + Vec3(0, 0, 1.3));
  for (const std::size_t k : painters_order(solids, view)) {
    const double tone = 0.94 + 0.12 * Rng(0, "block tones", numbers[k]).uniform();
    for (const Polytope::Face& face : solids[k].shape.faces) {
      if (glm::dot(face.plane.normal, view.to_viewer) <= 0.0) continue;
      std::vector<Vec2> outline;
      for (const std::uint32_t v : face.loop) outline.push_back(shift + scale * view.flat(solids[k].shape.vertices[v]));
      const double light = std::max(0.0, glm::dot(face.plane.normal, sun));
      svg.polygon(outline,
                  {.fill = shaded(set_colour(set_of(tile, face.joint)), light, tone), .stroke = "#333", .width = 0.6});
    }
  }
  // A scale bar of a round length, and where north is.
  double bar = std::pow(10.0, std::floor(std::log10(tile.side / 2.0)));
  if (5.0 * bar <= tile.side / 2.0)
    bar *= 5.0;
  else if (2.0 * bar <= tile.side / 2.0)
    bar *= 2.0;
  const Vec2 foot = frame.corner + Vec2(10.0, frame.size.y - 8.0);
  svg.line(foot, foot + Vec2(bar * scale, 0.0), {.stroke = "#222", .width = 2.5});
  svg.text(foot + Vec2(bar * scale + 6.0, 4.0), short_number(bar) + " m across the view", {.size = 11});
  const Vec2 compass = frame.corner + Vec2(frame.size.x - 46.0, frame.size.y - 26.0);
  const std::array<std::pair<Vec3, const char*>, 3> axes{std::pair{Vec3(1, 0, 0), "E"}, std::pair{Vec3(0, 1, 0), "N"},
                                                         std::pair{Vec3(0, 0, 1), "up"}};
  for (const auto& [axis, label] : axes) {
    const Vec2 tip = 30.0 * view.flat(glm::transpose(map_from_tile) * axis);
    svg.line(compass, compass + tip, {.stroke = "#222", .width = 1.3});
    svg.text(compass + 1.3 * tip + Vec2(0.0, 4.0), label, {.size = 10, .anchor = "middle"});
  }
}

}  // namespace outcrop

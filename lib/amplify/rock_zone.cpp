#include "rock_zone.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "outcrop/core/parallel.h"
#include "outcrop/terrain/distance_transform.h"

namespace outcrop {
namespace {

constexpr double kLedge = 0.65;          // Block sizes; half the width of ledges that blocks may cover.
constexpr double kNodesPerReach = 12.0;  // Of the raster of the envelopes.
constexpr double kRecessGrowth = 4.0;    // Metres of recess radius a metre from the rim: the base hides behind blocks at once.
constexpr double kAdvanceGrowth = 0.75;  // Of advance: blocks come out of the ground gradually.
constexpr double kSteepestFoot = 4.0;    // Tangent of the slope by which the base goes on below the foot of a wall.
constexpr double kLedgeTangent = 1.5;    // … and by which it sinks below a ledge.
constexpr int kRimSmoothing = 2;         // Nodes to either side, twice.
constexpr float kRimOffset = 1.0f;       // Nodes; what smoothing leaves on ground that is not steep, at most, along a straight rim.
constexpr float kRimSharpness = 2.0f;    // Where a rim bends, the true distance times this bounds the smoothed one.
constexpr double kProbesPerCell = 2.0;   // Slopes looked at across a cell of the heightfield, at least,
constexpr int kMostProbes = 4;           // … but no more than this many across a cell of the raster.
constexpr int kRuleMargin =
    2;  // Nodes of the coarse raster that a rule's border loses: bilinear weights are 0 beyond it.
constexpr double kRockMargin = 0.5;      // Of the reach: how far blocks of other rock reach into one that has none.
constexpr double kDownhill = 0.5;  // Tangent of a fall that counts as down to where the ground withdraws.
constexpr double kAdvanceWeight =
    4.0;  // The advance is whole where the weight is a quarter: blocks stand out of thin rock, too.
constexpr double kCertainlySteep = 1.005;  // Times the threshold's tangent: between two probes the slope may dip.
constexpr int kTile = 64;                // Nodes, across squares of the raster that are gentle as a whole or looked at.

/// A raster of nodes over a rectangle, rows from the south.
struct Raster {
  int width = 0, height = 0;
  Vec2 lo{0.0};
  double spacing = 1.0;

  static Raster over(const Vec2& lo, const Vec2& hi, double spacing) {
    const Vec2 extent = hi - lo;
    return {static_cast<int>(std::ceil(extent.x / spacing)) + 1, static_cast<int>(std::ceil(extent.y / spacing)) + 1, lo, spacing};
  }
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(width) * height; }
  [[nodiscard]] std::size_t index(int column, int row) const { return static_cast<std::size_t>(row) * width + column; }
  [[nodiscard]] Vec2 node(int column, int row) const { return lo + spacing * Vec2(column, row); }
  /// The index of a neighbour; beyond the border, of the nearest node.
  [[nodiscard]] std::size_t neighbour(int column, int row, int dx, int dy) const {
    return index(std::clamp(column + dx, 0, width - 1), std::clamp(row + dy, 0, height - 1));
  }
  /// Part of it: from node `first` to node `last`.
  [[nodiscard]] Raster part(const IVec2& first, const IVec2& last) const {
    return {last.x - first.x + 1, last.y - first.y + 1, node(first.x, first.y), spacing};
  }
  /// The part that holds all nodes of a rectangle and those around it.
  [[nodiscard]] Raster around(const Vec2& from, const Vec2& to) const {
    const IVec2 end(width - 1, height - 1);
    const IVec2 first = glm::clamp(IVec2(glm::floor((from - lo) / spacing)), IVec2(0), end - 1);
    const IVec2 last = glm::clamp(IVec2(glm::ceil((to - lo) / spacing)), first + 1, end);
    return part(first, last);
  }
  [[nodiscard]] Vec2 hi() const { return node(width - 1, height - 1); }
  /// The node next to a position.
  [[nodiscard]] std::size_t nearest(const Vec2& p) const {
    const Vec2 at = glm::round((p - lo) / spacing);
    return index(std::clamp(static_cast<int>(at.x), 0, width - 1), std::clamp(static_cast<int>(at.y), 0, height - 1));
  }

  [[nodiscard]] RasterLayer layer(std::vector<float> nodes) const { return {width, height, lo, spacing, std::move(nodes)}; }

  /// Calls visit(node's index, column, row) for each node, rows in parallel.
  template <class Visit>
  void for_each_node(const Visit& visit, const Task& task = {}) const {
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
      for (int column = 0; column < width; ++column) visit(index(column, static_cast<int>(row)), column, static_cast<int>(row));
      task.advance();
    }, task);
  }

  /// Distance in metres to the nearest node whose mark is `mark`, at most `farthest`.
  [[nodiscard]] std::vector<float> distance(std::vector<char> marks, bool mark, double farthest) const {
    for (char& m : marks) m = (m != 0) == mark;
    return distance_to_marked(width, height, Vec2(spacing), marks, static_cast<float>(farthest));
  }
};

/// Where the heightfield's bounds leave room for steep ground: a box around it, empty where they leave none.
struct SteepPart {
  Vec2 lo{std::numeric_limits<double>::infinity()}, hi{-std::numeric_limits<double>::infinity()};
  [[nodiscard]] bool empty() const { return lo.x > hi.x; }
};

SteepPart steep_part(const Heightfield& heightfield, const Raster& raster, double slope) {
  const double tangent = std::tan(slope), tile = kTile * raster.spacing;
  SteepPart part;
  for (int row = 0; row < raster.height; row += kTile)
    for (int column = 0; column < raster.width; column += kTile) {
      const Vec2 lo = raster.node(column, row), hi = glm::min(lo + tile, raster.hi());
      if (heightfield.slope_bound(lo, hi) < tangent) continue;
      part.lo = glm::min(part.lo, lo);
      part.hi = glm::max(part.hi, hi);
    }
  return part;
}

/// Nodes about which all the ground is steep, as far as the raster's next cells: so that bilinear interpolation between nodes
/// gives 0 wherever the ground is not.
std::vector<char> steep_nodes(const Heightfield& heightfield, const Raster& raster, double slope, const Task& task) {
  const double cell = std::min(heightfield.grid().cell_x, heightfield.grid().cell_y);
  const int probes = std::clamp(static_cast<int>(std::ceil(kProbesPerCell * raster.spacing / cell)), 1, kMostProbes);
  const Raster fine{(raster.width - 1) * probes + 1, (raster.height - 1) * probes + 1, raster.lo, raster.spacing / probes};
  const double steepness = std::pow(kCertainlySteep * std::tan(slope), 2.0);
  const double tangent = std::tan(slope);
  std::vector<char> steep(fine.count());
  parallel_for(static_cast<std::size_t>(fine.height), [&](std::size_t row) {
    for (int first = 0; first < fine.width; first += kTile) {
      const int end = std::min(first + kTile, fine.width);
      const int y = static_cast<int>(row);
      if (heightfield.slope_bound(fine.node(first, y), fine.node(end - 1, y)) < tangent) continue;
      for (int column = first; column < end; ++column) {
        const Vec2 p = fine.node(column, y);
        const Heightfield::Sample s = heightfield.at(p.x, p.y);
        steep[fine.index(column, y)] = s.hx * s.hx + s.hy * s.hy >= steepness &&
                                       (!heightfield.has_holes() || heightfield.hole_distance(p.x, p.y) < 0.0);
      }
    }
  }, Task{.stop = task.stop});  // Progress counts the raster's own rows.
  std::vector<char> all_about(raster.count());
  raster.for_each_node([&](std::size_t i, int column, int row) {
    bool all = true;
    for (int dy = -probes; dy <= probes && all; ++dy)
      for (int dx = -probes; dx <= probes && all; ++dx) all = steep[fine.neighbour(column * probes, row * probes, dx, dy)] != 0;
    all_about[i] = all;
  }, task);
  return all_about;
}

/// Morphological closing: ledges narrower than twice `ledge` count as wall. Wider flats keep every node.
void close_ledges(const Raster& raster, std::vector<char>& steep, double ledge) {
  const double farthest = ledge + 2.0 * raster.spacing;
  const std::vector<float> to_steep = raster.distance(steep, true, farthest);
  std::vector<char> grown(steep.size());
  for (std::size_t i = 0; i < grown.size(); ++i) grown[i] = to_steep[i] <= ledge;
  const std::vector<float> to_flat = raster.distance(std::move(grown), false, farthest);
  for (std::size_t i = 0; i < steep.size(); ++i) steep[i] = steep[i] || to_flat[i] > ledge;
}

/// Means over squares of 2 · `radius` + 1 nodes; beyond the border the border goes on.
std::vector<float> box_mean(const Raster& raster, const std::vector<float>& nodes, int radius) {
  std::vector<float> along_x(nodes.size()), mean(nodes.size());
  const float share = 1.0f / static_cast<float>(2 * radius + 1);
  raster.for_each_node([&](std::size_t i, int column, int row) {
    for (int d = -radius; d <= radius; ++d) along_x[i] += share * nodes[raster.neighbour(column, row, d, 0)];
  });
  raster.for_each_node([&](std::size_t i, int column, int row) {
    for (int d = -radius; d <= radius; ++d) mean[i] += share * along_x[raster.neighbour(column, row, 0, d)];
  });
  return mean;
}

/// Distance of each steep node to ground that is not, 0 there; without the steps that a rim on nodes has.
std::vector<float> distance_to_rim(const Raster& raster, const std::vector<char>& steep, double farthest) {
  std::vector<float> distance = raster.distance(steep, false, farthest);
  std::vector<float> smooth = box_mean(raster, box_mean(raster, distance, kRimSmoothing), kRimSmoothing);
  for (std::size_t i = 0; i < distance.size(); ++i)
    distance[i] = std::min(kRimSharpness * distance[i], std::max(smooth[i] - kRimOffset * static_cast<float>(raster.spacing), 0.0f));
  return distance;
}

/// A node near by, and how much of its height counts: all within a radius, none a node beyond it.
struct Neighbour {
  int dx, dy;
  float recess, advance;
};

/// The nodes within two radii.
std::vector<Neighbour> disc(double recess_radius, double advance_radius, double spacing) {
  const int reach = static_cast<int>(std::ceil(std::max(recess_radius, advance_radius) / spacing));
  std::vector<Neighbour> nodes;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const auto weight = [distance = spacing * std::hypot(dx, dy), spacing](double radius) {
        return static_cast<float>(std::clamp(1.0 + (radius - distance) / spacing, 0.0, 1.0));
      };
      const Neighbour n{dx, dy, weight(recess_radius), weight(advance_radius)};
      if (n.recess > 0.0f || n.advance > 0.0f) nodes.push_back(n);
    }
  return nodes;
}

/// How far the ground falls and rises within the reach, and the least weight of the ground down to where it withdraws.
struct Envelopes {
  RasterLayer fall, rise, weight;
};

template <class Near, class Reach>
Envelopes make_envelopes(const Heightfield& heightfield, const Raster& raster, double recess, const Near& near,
                         const Reach& reach_at, const RasterLayer* rule, const Task& task) {
  std::vector<float> ground(raster.count()), fall(raster.count(), 0.0f), rise(raster.count(), 0.0f);
  std::vector<float> own(rule ? raster.count() : 0), weight(rule ? raster.count() : 0, 1.0f);
  raster.for_each_node([&](std::size_t i, int column, int row) {
    const Vec2 p = raster.node(column, row);
    ground[i] = static_cast<float>(heightfield.at(p.x, p.y).h);
    if (rule) own[i] = static_cast<float>(rule->at(p.x, p.y).h);
  });
  parallel_for(static_cast<std::size_t>(raster.height), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    std::vector<Neighbour> neighbours;
    double radius = -1.0;  // Theirs; it changes where the material does.
    for (int column = 0; column < raster.width; ++column) {
      const Vec2 p = raster.node(column, row);
      if (!near(p)) continue;
      if (const double reach = reach_at(p); reach != radius) {
        radius = reach;
        neighbours = disc(recess * radius, radius, raster.spacing);
      }
      const std::size_t i = raster.index(column, row);
      float fallen = 0.0f, risen = 0.0f;
      for (const Neighbour& n : neighbours) {
        const float difference = ground[raster.neighbour(column, row, n.dx, n.dy)] - ground[i];
        fallen = std::max(fallen, -n.recess * difference);
        risen = std::max(risen, n.advance * difference);
        if (!rule || (n.dx == 0 && n.dy == 0)) continue;
        // Ground beside counts less the more level it lies, so that the least weight does not jump.
        const double level = kDownhill * raster.spacing * std::hypot(n.dx, n.dy);
        const float down = n.recess * static_cast<float>(std::clamp(-difference / level, 0.0, 1.0));
        weight[i] = std::min(weight[i], 1.0f - down * (1.0f - own[raster.neighbour(column, row, n.dx, n.dy)]));
      }
      fall[i] = fallen;
      rise[i] = risen;
    }
    task.advance();
  }, task);
  return {raster.layer(std::move(fall)), raster.layer(std::move(rise)),
          rule ? raster.layer(std::move(weight)) : RasterLayer()};
}

/// f(point of the surface) on a raster, [0, 1]; 1 at nodes that are not wanted, and where there is no f.
template <class Wanted>
std::vector<float> weights_on(const Heightfield& heightfield, const Raster& raster,
                              const std::function<double(const Vec3&)>& f, const Wanted& wanted) {
  std::vector<float> weights(raster.count(), 1.0f);
  if (!f) return weights;
  raster.for_each_node([&](std::size_t i, int column, int row) {
    const Vec2 p = raster.node(column, row);
    if (wanted(p)) weights[i] = static_cast<float>(std::clamp(f(Vec3(p, heightfield.at(p.x, p.y).h)), 0.0, 1.0));
  });
  return weights;
}

/// The weight of the ground: 0 wherever weight_at is, which nodes within kRuleMargin of such a one make sure.
///
/// @param near  Calls back for a position: is there steep ground within a distance?
template <class Near>
RasterLayer make_weight(const Heightfield& heightfield, const Raster& raster, const RockZoneOptions& options,
                        const Near& near) {
  const double half_reach = kRockMargin * options.reach, margin = (kRuleMargin + 3) * raster.spacing;
  const std::vector<float> place =
      weights_on(heightfield, raster, options.weight_at, [&](const Vec2& p) { return near(p, margin); });
  const std::vector<float> rock = weights_on(heightfield, raster, options.rock_weight_at,
                                       [&](const Vec2& p) { return near(p, margin + half_reach); });
  std::vector<float> weight(raster.count(), 1.0f);
  const std::vector<Neighbour> neighbours = disc(half_reach, half_reach, raster.spacing);
  raster.for_each_node([&](std::size_t i, int column, int row) {
    if (!near(raster.node(column, row), margin)) return;
    weight[i] = place[i];
    for (int dy = -kRuleMargin; dy <= kRuleMargin; ++dy)
      for (int dx = -kRuleMargin; dx <= kRuleMargin; ++dx)
        if (place[raster.neighbour(column, row, dx, dy)] <= 0.0f) weight[i] = 0.0f;
    if (!options.rock_weight_at) return;
    float largest = 0.0f;
    for (const Neighbour& n : neighbours)
      largest = std::max(largest, n.recess * rock[raster.neighbour(column, row, n.dx, n.dy)]);
    weight[i] = std::min(weight[i], largest);
  });
  return raster.layer(std::move(weight));
}

/// For each node the nearest one that is marked, within `radius`, else itself.
NearestGround nearest_ground(const Raster& raster, const std::vector<char>& marked, double radius) {
  std::vector<Neighbour> neighbours = disc(radius, radius, raster.spacing);
  std::ranges::stable_sort(neighbours, {}, [](const Neighbour& n) { return n.dx * n.dx + n.dy * n.dy; });
  const std::vector<float> distance = raster.distance(marked, true, radius + 2.0 * raster.spacing);
  std::vector<Vec2> nodes(raster.count());
  raster.for_each_node([&](std::size_t i, int column, int row) {
    nodes[i] = raster.node(column, row);
    if (distance[i] > radius) return;
    for (const Neighbour& n : neighbours)
      if (marked[raster.neighbour(column, row, n.dx, n.dy)]) {
        nodes[i] =
            raster.node(std::clamp(column + n.dx, 0, raster.width - 1), std::clamp(row + n.dy, 0, raster.height - 1));
        break;
      }
  });
  return {raster.width, raster.height, raster.lo, raster.spacing, std::move(nodes)};
}

}  // namespace

Vec2 NearestGround::at(const Vec2& p) const noexcept {
  if (!nodes_) return p;
  const Vec2 place = glm::clamp(glm::round((p - lo_) / spacing_), Vec2(0.0), Vec2(width_ - 1, height_ - 1));
  return (*nodes_)[static_cast<std::size_t>(place.y) * width_ + static_cast<std::size_t>(place.x)];
}

RockZone make_rock_zone(const Heightfield& heightfield, const RockZoneOptions& options, const Task& task) {
  const double largest_radius = options.reach * std::max(1.0, options.recess);
  const double ledge = kLedge * options.block_size;
  const double coarse_spacing = std::max(options.spacing, options.reach / kNodesPerReach);
  // Gentle ground costs its bounds alone: rasters end where nothing steep is near, and are 0 beyond.
  const Raster everything = Raster::over(options.lo, options.hi, options.spacing);
  const SteepPart part = steep_part(heightfield, everything, options.slope);
  if (part.empty()) return {.slope = options.slope};
  const double near = largest_radius + 2.0 * ledge + 4.0 * coarse_spacing;
  const Raster coarse =
      Raster::over(options.lo, options.hi, coarse_spacing).around(part.lo - 2.0 * near, part.hi + 2.0 * near);
  const Raster raster = everything.around(part.lo - near, part.hi + near);
  task.begin("finding steep ground", static_cast<std::uint64_t>(raster.height) + coarse.height);
  const auto reach_at = [&](const Vec2& p) {
    return options.reach_at ? options.reach_at(Vec3(p, heightfield.at(p.x, p.y).h)) : options.reach;
  };
  std::vector<char> steep = steep_nodes(heightfield, raster, options.slope, task);
  if (options.reach_at)
    raster.for_each_node([&](std::size_t i, int column, int row) { steep[i] = steep[i] && reach_at(raster.node(column, row)) > 0.0; });
  close_ledges(raster, steep, ledge);
  RockZone zone{.weighted = options.weight_at || options.rock_weight_at || options.rim > 0.0, .slope = options.slope};
  RasterLayer rule;
  const bool ruled = options.weight_at || options.rock_weight_at;
  if (ruled) {
    const double farthest = (kRuleMargin + 5) * coarse.spacing + options.reach;
    const std::vector<float> distance = raster.distance(steep, true, farthest);
    rule = make_weight(heightfield, coarse, options,
                       [&](const Vec2& p, double radius) { return distance[raster.nearest(p)] <= radius; });
    raster.for_each_node([&](std::size_t i, int column, int row) {
      const Vec2 p = raster.node(column, row);
      steep[i] = steep[i] && rule.at(p.x, p.y).h > 0.0;
    });
  }

  const std::vector<float> to_steep = raster.distance(steep, true, largest_radius + 2.0 * coarse.spacing);
  const auto near_steep = [&](const Vec2& p, double radius) { return to_steep[raster.nearest(p)] <= radius; };
  const Envelopes envelopes = make_envelopes(
      heightfield, coarse, options.recess, [&](const Vec2& p) { return near_steep(p, 2.0 * coarse.spacing); }, reach_at,
      ruled ? &rule : nullptr, task);
  std::vector<float> nearby(coarse.count());
  coarse.for_each_node([&](std::size_t i, int column, int row) {
    nearby[i] = near_steep(coarse.node(column, row), largest_radius + coarse.spacing) ? 1.0f : 0.0f;
  });

  const std::vector<float> rim = distance_to_rim(raster, steep, largest_radius / kAdvanceGrowth + raster.spacing);
  const auto rim_weight = [&](std::size_t i) { return options.rim > 0.0 ? std::min(rim[i] / options.rim, 1.0) : 1.0; };
  const auto weight_of_rule = [&](const Vec2& p) { return ruled ? rule.at(p.x, p.y).h : 1.0; };
  if (zone.weighted) {
    std::vector<float> rims(coarse.count()), weights(coarse.count());
    std::vector<char> marked(coarse.count());
    coarse.for_each_node([&](std::size_t i, int column, int row) {
      const Vec2 p = coarse.node(column, row);
      const std::size_t fine = raster.nearest(p);
      rims[i] = static_cast<float>(rim_weight(fine));
      weights[i] = static_cast<float>(weight_of_rule(p) * rims[i]);
      marked[i] = steep[fine];
    });
    zone.ground = nearest_ground(coarse, marked, largest_radius + coarse.spacing);
    zone.rim = coarse.layer(std::move(rims));
    zone.weight = coarse.layer(std::move(weights));
  }
  std::vector<float> recess(raster.count(), 0.0f), advance(raster.count(), 0.0f);
  raster.for_each_node([&](std::size_t i, int column, int row) {
    if (!steep[i]) return;
    const Vec2 p = raster.node(column, row);
    const Heightfield::Sample s = heightfield.at(p.x, p.y);
    const double slope = std::min(std::hypot(s.hx, s.hy), kSteepestFoot);
    const double reach = reach_at(p);
    // At the foot of a wall the lowest ground near by is the floor itself; blocks stand below it all the same.
    recess[i] = static_cast<float>(std::max(std::min(envelopes.fall.at(p.x, p.y).h, kLedgeTangent * kRecessGrowth * rim[i]),
                                            slope * std::min<double>(kRecessGrowth * rim[i], options.recess * reach)));
    advance[i] = static_cast<float>(
        std::min(envelopes.rise.at(p.x, p.y).h, std::max(slope, 1.0) * kAdvanceGrowth * rim[i]));
    if (!zone.weighted) return;
    const double weight = weight_of_rule(p) * rim_weight(i);
    // Where few blocks stand the base must not gape as a pit, nor reach down to where none do.
    const double withdrawn = ruled ? std::min<double>(weight, envelopes.weight.at(p.x, p.y).h) : weight;
    recess[i] *= static_cast<float>(withdrawn * withdrawn);
    advance[i] *= static_cast<float>(std::min(kAdvanceWeight * weight, 1.0));
  });
  zone.empty = std::ranges::none_of(steep, [](char s) { return s != 0; });
  zone.recess = raster.layer(std::move(recess));
  zone.advance = raster.layer(std::move(advance));
  zone.nearby = coarse.layer(std::move(nearby));
  return zone;
}

}  // namespace outcrop

#include "outcrop/fracture/clusters.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "joint_laws.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "region.h"
#include "sheets.h"

namespace outcrop {
namespace {

constexpr double kTolerance = 1e-10;  // Of the side: vertices nearer to a plane than this are on it.
constexpr double kPersistent = 0.5 * kPersistentRadius;  // Of the side: discs of larger radius are persistent.

/// Which sets end at which.
class Terminations {
 public:
  explicit Terminations(const std::vector<JointSet>& sets)
      : count_(sets.size()), ages_(joint_ages(sets)), at_(count_ * (count_ + 1), false) {
    for (std::size_t s = 0; s < count_; ++s)
      for (const std::string& name : sets[s].ends_at)
        for (std::size_t other = 0; other <= count_; ++other)
          if (name == (other < count_ ? std::string_view(sets[other].name) : kColumns))
            at_[s * (count_ + 1) + other] = true;
  }

  [[nodiscard]] bool at(std::size_t set, std::size_t other) const { return at_[set * (count_ + 1) + other]; }

  /// Whether a set ends at what lies along a face.
  [[nodiscard]] bool at(int set, int joint, const std::vector<Disc>& discs) const {
    if (set < 0) return false;
    if (joint == kColumnJoint || joint == kTierJoint) return at(static_cast<std::size_t>(set), count_);
    if (joint < 0 || discs[static_cast<std::size_t>(joint)].set < 0) return false;
    return at(static_cast<std::size_t>(set), static_cast<std::size_t>(discs[static_cast<std::size_t>(joint)].set));
  }
  [[nodiscard]] const std::vector<int>& ages() const noexcept { return ages_; }

 private:
  std::size_t count_;
  std::vector<int> ages_;
  std::vector<bool> at_;  ///< [set][other]; the last other are columns.
};

/// Parts one cell after the other by the discs that reach it.
class CellSplitter {
 public:
  /// @param drawn  How many of the discs were drawn; after them come walls of regions, and the sheets that join them.
  CellSplitter(const std::vector<Vec3>& samples, const Graph& graph, std::vector<Disc>& discs, std::size_t drawn,
               const ClusterOptions& options, Seed seed)
      : graph_(graph),
        discs_(discs),
        drawn_(drawn),
        options_(options),
        seed_(seed),
        ends_(options.sets),
        sheets_(discs, options, seed),
        owner_(samples.size(), 0),
        position_(samples.size(), Vec3(0.0)),
        height_(samples.size(), 0.0) {}

  /// The clusters of a region without periods, those below a joint before those above it.
  void split(Region region, std::vector<Cluster>& clusters) {
    std::vector<Node> stack;
    stack.push_back(root(std::move(region)));
    while (!stack.empty()) {
      Node node = std::move(stack.back());
      stack.pop_back();
      if (node.next == node.images.size()) {
        if (auto halves = halved(node); !halves.empty()) {
          stack.push_back(std::move(halves[1]));
          stack.push_back(std::move(halves[0]));
        } else {
          clusters.push_back(finished(std::move(node)));
        }
        continue;
      }
      const DiscImage image = node.images[node.next++];
      if (image.disc < 0) {
        add_sheets(node, static_cast<std::size_t>(kFirstSheets - image.disc));
        stack.push_back(std::move(node));
      } else if (auto parts = parted(node, image); !parts.empty()) {
        stack.push_back(std::move(parts[1]));
        stack.push_back(std::move(parts[0]));
      } else {
        stack.push_back(std::move(node));
      }
    }
  }

  [[nodiscard]] std::size_t stopped() const noexcept { return stopped_; }
  [[nodiscard]] std::size_t halvings() const noexcept { return halvings_; }

 private:
  static constexpr int kFirstSheets = -1;
  struct DiscImage {
    int disc;  ///< −1 − set: here come the sheets of a persistent set.
    Vec3 centre;
    bool again = false;  ///< It ended in a larger cell before.
  };
  struct Node {
    Polytope shape;
    std::vector<std::uint32_t> samples;
    std::vector<DiscImage> images;
    std::size_t next = 0;
    std::uint32_t id = 0;
    std::vector<std::uint64_t> compartments;  ///< Of each set: which of the pieces that its joints alone would make.
  };

  Node root(Region region) {
    Node node;
    node.id = ++last_id_;
    node.samples = std::move(region.samples);
    for (std::size_t k = 0; k < node.samples.size(); ++k) {
      owner_[node.samples[k]] = node.id;
      position_[node.samples[k]] = region.positions[k];
    }
    Vec3 middle{0.0};
    if (!region.walls.empty()) {
      std::vector<Plane> planes;
      for (const Region::Wall& wall : region.walls) planes.push_back(wall.plane);
      middle = inscribed_ball(planes, -planes[0].offset * planes[0].normal, options_.side).centre;
    }
    // No cell is wider: its walls are a tile apart and at least 30° from each other.
    node.shape = box_polytope(Box{middle, middle}.grown(16.0 * options_.side));
    for (const Region::Wall& wall : region.walls)
      node.shape = clipped(node.shape, wall.plane, wall.joint, kTolerance * options_.side);
    for (const Polytope::Face& face : node.shape.faces)
      assert(face.joint != kWall || options_.domain == Domain::Box), (void)face;
    node.compartments.assign(options_.sets.size(), 0);
    sheets_.enter(region, node.shape);
    add_images(node, region.spent);
    return node;
  }

  // What cuts a cell, in order of age: the sheets of persistent sets, then the discs.
  void add_images(Node& node, const std::vector<int>& spent) const {
    int oldest = -1;
    std::size_t i = 0;
    const std::vector<int>& ages = ends_.ages();
    const int youngest = ages.empty() ? 0 : *std::max_element(ages.begin(), ages.end());
    for (int age = oldest; age <= youngest; ++age) {
      for (std::size_t s = 0; s < ages.size(); ++s)
        if (ages[s] == age && is_persistent(options_.sets[s]))
          node.images.push_back({kFirstSheets - static_cast<int>(s), Vec3(0.0)});
      for (; i < drawn_ && discs_[i].age <= age; ++i) add_images_of(node, static_cast<int>(i), spent);
    }
  }

  // Every image of a disc whose sphere reaches the cell's bounds, unless it ends at a wall before.
  void add_images_of(Node& node, int i, const std::vector<int>& spent) const {
    if (std::find(spent.begin(), spent.end(), i) != spent.end()) return;
    const Box bounds = node.shape.bounds();
    const double side = options_.side;
    const Disc& disc = discs_[static_cast<std::size_t>(i)];
    Vec3 lo = glm::ceil((bounds.lo - disc.radius - disc.centre) / side);
    Vec3 hi = glm::floor((bounds.hi + disc.radius - disc.centre) / side);
    if (options_.domain == Domain::Box) lo = hi = Vec3(0.0);
    for (double z = lo.z; z <= hi.z; ++z)
      for (double y = lo.y; y <= hi.y; ++y)
        for (double x = lo.x; x <= hi.x; ++x) {
          const Vec3 centre = disc.centre + side * Vec3(x, y, z);
          const bool is_blocked =
              disc.ends && std::any_of(node.shape.faces.begin(), node.shape.faces.end(), [&](const Polytope::Face& face) {
                return ends_.at(disc.set, face.joint, discs_) && blocks(node.shape, face.plane, centre, node.shape);
              });
          if (!is_blocked) node.images.push_back({i, centre});
        }
  }

  // Whether a joint across a convex piece of rock stands between a disc's centre and a part of the piece: the straight
  // way from one to the other meets the joint's plane in the piece.
  [[nodiscard]] bool blocks(const Polytope& piece, const Plane& plane, const Vec3& centre, const Polytope& part) const {
    const double from = plane.distance(centre);
    const Vec3 middle = part.middle();
    const double to = plane.distance(middle);
    if (from * to >= 0.0) return false;
    const Vec3 way = centre + from / (from - to) * (middle - centre);
    const double tolerance = kTolerance * options_.side;
    return std::all_of(piece.faces.begin(), piece.faces.end(),
                       [&](const Polytope::Face& face) { return face.plane.distance(way) <= tolerance; });
  }

  // The sheets of a persistent set that cross the cell come next: those that pass all others first.
  void add_sheets(Node& node, std::size_t s) {
    const JointSet& set = options_.sets[s];
    const Box bounds = node.shape.bounds();
    const double ending = set.ends_at.empty() ? 0.0 : set.ends_share;
    std::vector<int> discs;
    if (ending < 1.0) discs = sheets_.crossing(s, 0, 1.0 - ending, bounds);
    if (ending > 0.0) {
      std::uint64_t compartment = 1;
      for (std::size_t other = 0; other < options_.sets.size(); ++other)
        if (ends_.at(s, other)) compartment = Rng(compartment, "compartments", node.compartments[other]).next();
      const std::vector<int> more = sheets_.crossing(s, compartment, ending, bounds);
      discs.insert(discs.end(), more.begin(), more.end());
    }
    std::vector<DiscImage> images;
    for (const int i : discs) images.push_back({i, discs_[static_cast<std::size_t>(i)].centre});
    node.images.insert(node.images.begin() + static_cast<std::ptrdiff_t>(node.next), images.begin(), images.end());
  }

  // Whether the disc may meet the cell: no face has it all outside.
  [[nodiscard]] bool reaches(const Polytope& shape, const Disc& disc, const Vec3& centre) const {
    for (const Polytope::Face& face : shape.faces) {
      const double c = glm::dot(disc.normal, face.plane.normal);
      const double extent = disc.radius * std::sqrt(std::max(0.0, 1.0 - c * c));
      if (face.plane.distance(centre) > extent) return false;
    }
    return true;
  }

  // The two sides of a joint, or nothing where it does not enter the cell or ends in it. A persistent joint that would
  // cut a chip or a blade off a large cell is tried again in the cells that joints of its age leave: it ends there only.
  std::vector<Node> parted(Node& node, const DiscImage& image) {
    Sides part = sides_of(node, image);
    if (!part.is_stopped) return std::move(part.parts);
    const Disc& disc = discs_[static_cast<std::size_t>(image.disc)];
    if (image.again || disc.radius <= kPersistent * options_.side) {
      ++stopped_;
      return {};
    }
    const auto younger = std::find_if(
        node.images.begin() + static_cast<std::ptrdiff_t>(node.next), node.images.end(), [&](const DiscImage& later) {
          const int age = later.disc >= 0 ? discs_[static_cast<std::size_t>(later.disc)].age
                                          : ends_.ages()[static_cast<std::size_t>(kFirstSheets - later.disc)];
          return age > disc.age;
        });
    node.images.insert(younger, {image.disc, image.centre, true});
    return {};
  }

  struct Sides {
    std::vector<Node> parts;  ///< None where the joint does not enter.
    bool is_stopped = false;  ///< It would, but for what it would leave.
  };
  Sides sides_of(const Node& node, const DiscImage& image) {
    const Disc& disc = discs_[static_cast<std::size_t>(image.disc)];
    const Plane plane{disc.normal, -glm::dot(disc.normal, image.centre)};
    const Interval range = node.shape.distances(plane);
    const double tolerance = kTolerance * options_.side;
    if (range.lo >= -tolerance || range.hi <= tolerance || !reaches(node.shape, disc, image.centre)) return {};
    if (!enters(node, disc, image.centre, plane)) return {};

    std::size_t below = 0;
    for (const std::uint32_t i : node.samples) below += height_[i] < 0.0;
    const auto fewest = static_cast<std::size_t>(options_.min_samples);
    if (below < fewest || node.samples.size() - below < fewest) return {.is_stopped = true};
    std::vector<Node> parts = sides(node, plane, image.disc);
    for (const Node& part : parts)
      if (part.shape.empty() || is_blade(part.shape) || is_thin(part.shape)) return {.is_stopped = true};
    share_out(node, parts, plane, image.disc);
    return {std::move(parts)};
  }

  // A joint across the middle of a cell that is too long, as slender blocks break; nothing for the others.
  std::vector<Node> halved(const Node& node) {
    const Vec3 size = node.shape.bounds().size();
    if (std::max(size.x, std::max(size.y, size.z)) <= options_.longest) return {};
    // Along the joints across which it is longest.
    Vec3 normal = size.x >= size.y && size.x >= size.z ? Vec3(1, 0, 0)
                  : size.y >= size.z                   ? Vec3(0, 1, 0)
                                                       : Vec3(0, 0, 1);
    double longest = 0.0;
    for (const Disc& disc : discs_)
      if (const double width = node.shape.distances({disc.normal, 0.0}).width(); width > longest) {
        longest = width;
        normal = disc.normal;
      }
    const Interval range = node.shape.distances({normal, 0.0});
    const double share = Rng(seed_, "halving joints", halvings_).uniform(0.4, 0.6);
    const Plane plane{normal, -(range.lo + share * range.width())};
    std::size_t below = 0;
    for (const std::uint32_t i : node.samples) {
      height_[i] = plane.distance(position_[i]);
      below += height_[i] < 0.0;
    }
    if (below == 0 || below == node.samples.size()) return {};  // a sliver
    ++halvings_;
    std::vector<Node> parts = sides(node, plane, kAddedJoint);
    share_out(node, parts, plane, kAddedJoint);
    return parts;
  }

  // The shapes below and above a plane.
  [[nodiscard]] std::vector<Node> sides(const Node& node, const Plane& plane, int joint) const {
    const double tolerance = kTolerance * options_.side;
    std::vector<Node> parts(2);
    parts[0].shape = clipped(node.shape, plane, joint, tolerance);
    parts[1].shape = clipped(node.shape, {-plane.normal, -plane.offset}, joint, tolerance);
    return parts;
  }

  [[nodiscard]] bool is_thin(const Polytope& shape) const {
    return options_.min_inradius > 0.0 && inscribed_ball(shape).radius < options_.min_inradius;
  }

  // Whether the newest face meets another at less than the least angle.
  [[nodiscard]] bool is_blade(const Polytope& shape) const {
    const Polytope::Face& cut = shape.faces.back();
    for (const Polytope::Face& face : shape.faces) {
      if (glm::dot(face.plane.normal, cut.plane.normal) > -std::cos(options_.least_angle) || &face == &cut) continue;
      int shared = 0;
      for (const std::uint32_t v : face.loop)
        shared += std::find(cut.loop.begin(), cut.loop.end(), v) != cut.loop.end();
      if (shared >= 2) return true;
    }
    return false;
  }

  // Samples and coming discs go to the side that they are on, discs to both unless they end at this joint.
  void share_out(const Node& node, std::vector<Node>& parts, const Plane& plane, int joint) {
    const int set = joint >= 0 ? discs_[static_cast<std::size_t>(joint)].set : -1;
    for (std::size_t side = 0; side < parts.size(); ++side) {
      Node& part = parts[side];
      part.id = ++last_id_;
      part.compartments = node.compartments;
      if (set >= 0) {
        std::uint64_t& compartment = part.compartments[static_cast<std::size_t>(set)];
        compartment = Rng(compartment ^ std::bit_cast<std::uint64_t>(plane.offset), "compartments", 2 * joint + side).next();
      }
      const Box bounds = part.shape.bounds();
      for (std::size_t k = node.next; k < node.images.size(); ++k) {
        const DiscImage& later = node.images[k];
        if (later.disc >= 0) {
          const Disc& disc = discs_[static_cast<std::size_t>(later.disc)];
          const bool is_near = disc.radius > options_.side * kPersistent
                                   ? crosses({disc.normal, -glm::dot(disc.normal, later.centre)}, bounds)
                                   : bounds.grown(disc.radius).contains(later.centre);
          if (!is_near) continue;
          if (disc.ends && ends_.at(disc.set, joint, discs_) && blocks(node.shape, plane, later.centre, part.shape))
            continue;
        }
        part.images.push_back(later);
      }
    }
    for (const std::uint32_t i : node.samples) {
      Node& part = parts[height_[i] < 0.0 ? 0 : 1];
      owner_[i] = part.id;
      part.samples.push_back(i);
    }
  }

  // Whether the disc lies between samples that see each other, and covers enough of what its plane parts.
  // Writes the samples' distances from the plane.
  bool enters(const Node& node, const Disc& disc, const Vec3& centre, const Plane& plane) {
    for (const std::uint32_t i : node.samples) height_[i] = plane.distance(position_[i]);
    if (disc.radius > kPersistent * options_.side) return true;
    std::size_t through_plane = 0;
    std::size_t through_disc = 0;
    for (const std::uint32_t i : node.samples) {
      const double below = height_[i];
      if (below >= 0.0 || below < -options_.sight) continue;
      for (std::uint32_t e = graph_.first[i]; e < graph_.first[i + 1]; ++e) {
        const std::uint32_t j = graph_.targets[e];
        if (owner_[j] != node.id || height_[j] < 0.0) continue;
        // Neighbours around the torus may be far apart in the cell: then they see each other through its walls.
        const Vec3 d = position_[j] - position_[i];
        if (glm::dot(d, d) > options_.sight * options_.sight * (1.0 + 1e-9)) continue;
        const Vec3 from_centre = position_[i] + below / (below - height_[j]) * d - centre;
        ++through_plane;
        through_disc += glm::dot(from_centre, from_centre) <= disc.radius * disc.radius;
      }
    }
    return through_disc > 0 &&
           static_cast<double>(through_disc) >= options_.covered_share * static_cast<double>(through_plane);
  }

  Cluster finished(Node node) const {
    Cluster cluster;
    cluster.shape = std::move(node.shape);
    for (const std::uint32_t i : node.samples) cluster.positions.push_back(position_[i]);
    cluster.samples = std::move(node.samples);
    return cluster;
  }

  const Graph& graph_;
  std::vector<Disc>& discs_;
  std::size_t drawn_;
  const ClusterOptions& options_;
  Seed seed_;
  Terminations ends_;
  SheetSource sheets_;
  std::vector<std::uint32_t> owner_;  // Of each sample: the id of its node.
  std::vector<Vec3> position_;        // Of each sample in its cell.
  std::vector<double> height_;        // Of each sample over the plane in question.
  std::uint32_t last_id_ = 0;
  std::size_t stopped_ = 0;
  std::size_t halvings_ = 0;
};

// @param discs  The first `drawn` cut; regions refer to all.
Clusters split_regions(std::vector<Region> regions, const std::vector<Vec3>& samples, const Graph& graph,
                       std::vector<Disc> discs, std::size_t drawn, const ClusterOptions& options, Seed seed,
                       const Task& task) {
  Clusters clusters;
  clusters.discs = std::move(discs);
  CellSplitter cells(samples, graph, clusters.discs, drawn, options, seed);
  for (std::size_t layer = 0; layer < regions.size(); ++layer) {
    task.check();
    const std::size_t first = clusters.list.size();
    cells.split(std::move(regions[layer]), clusters.list);
    for (std::size_t i = first; i < clusters.list.size(); ++i) clusters.list[i].layer = static_cast<int>(layer);
  }
  clusters.stopped_joints = cells.stopped();
  clusters.added_joints = cells.halvings();
  return clusters;
}

void check(const std::vector<Vec3>& samples, const Graph& graph, const ClusterOptions& options) {
  require(graph.first.size() == samples.size() + 1, "graph", "one row a sample",
          static_cast<double>(graph.first.size()));
  require(options.columns.empty() || options.domain == Domain::Torus, "columns", "none in a box",
          static_cast<double>(options.columns.size()));
}

// What the regions' walls were made of, as far as it is discs.
std::vector<int> wall_discs(const std::vector<Region>& regions) {
  std::vector<int> walls;
  for (const Region& region : regions) walls.insert(walls.end(), region.spent.begin(), region.spent.end());
  std::sort(walls.begin(), walls.end());
  walls.erase(std::unique(walls.begin(), walls.end()), walls.end());
  return walls;
}

// The discs but for those that drawn walls stand in for: of each wall the nearest of its set.
std::vector<Disc> without_stand_ins(std::vector<Disc> discs, const std::vector<Disc>& walls, double side) {
  for (const Disc& wall : walls) {
    const auto cost = [&](const Disc& other) {
      const double turn = 1.0 - std::abs(glm::dot(other.normal, wall.normal));
      const double apart = std::abs(glm::dot(wall.normal, wrapped_difference(wall.centre, other.centre, side)));
      return (other.set == wall.set && other.age >= 0 ? 0.0 : 4.0 * side) + side * turn + apart;
    };
    const auto nearest = std::min_element(discs.begin(), discs.end(),
                                          [&](const Disc& a, const Disc& b) { return cost(a) < cost(b); });
    if (nearest != discs.end() && nearest->set == wall.set && nearest->age >= 0) discs.erase(nearest);
  }
  return discs;
}

// Every region's first two walls are its layer's floor and ceiling, the next two those of its rod, then its ends.
TileLayout layout_of(const std::vector<Region>& regions, double side) {
  TileLayout layout{.normal = regions[0].walls[1].plane.normal, .pitch = 0.0, .layers = {}, .slides = true};
  for (const Region& region : regions) {
    const auto offset = [&](std::size_t wall) { return region.walls[wall].plane.offset; };
    const Vec3 period = side * Vec3(region.axis);
    layout.layers.push_back({.floor = offset(0),
                             .thickness = -offset(1) - offset(0),
                             .side_normal = region.walls[3].plane.normal,
                             .side_offset = offset(2),
                             .side_pitch = -offset(3) - offset(2),
                             .axis = glm::normalize(period),
                             .period = glm::length(period),
                             .end_normal = region.walls[5].plane.normal,
                             .end_offset = offset(4)});
    layout.pitch += layout.layers.back().thickness;
  }
  return layout;
}

// Slabs along x and rods along z, whose columns go through from tile to tile.
TileLayout layout_of_columns(std::size_t tiers, double side) {
  TileLayout layout = TileLayout::lattice(side);
  layout.normal = Vec3(1, 0, 0);
  layout.layers[0].axis = layout.layers[0].end_normal = Vec3(0, 0, 1);
  layout.slides = layout.whole_rods = true;
  layout.level = tiers > 1;
  return layout;
}

}  // namespace

Clusters split_samples(const std::vector<Vec3>& samples, const Graph& graph, const std::vector<Disc>& discs,
                       const ClusterOptions& options, Seed seed, const Task& task) {
  check(samples, graph, options);
  std::vector<Disc> all = discs;
  RegionSplitter splitter(all, options, seed);
  std::vector<Region> regions = splitter.run(samples);
  Clusters clusters = split_regions(std::move(regions), samples, graph, std::move(all), discs.size(), options, seed, task);
  clusters.added_joints += splitter.added_joints();
  clusters.largest_bend = splitter.largest_bend();
  return clusters;
}

TileVariants split_variants(const std::vector<Vec3>& samples, const Graph& graph, const Drawn& base,
                            const std::vector<Drawn>& others, const ClusterOptions& options, const Task& task) {
  check(samples, graph, options);
  require(options.domain == Domain::Torus, "variants", "1 in a box", static_cast<double>(others.size() + 1));
  TileVariants variants;
  if (!options.columns.empty()) {
    variants.layout = layout_of_columns(options.columns.size(), options.side);
    variants.others = parallel_map(
        others.size(),
        [&](std::size_t i) { return split_samples(samples, graph, others[i].discs, options, others[i].seed, task); }, task);
    for (Clusters& clusters : variants.others)
      for (Cluster& cluster : clusters.list) cluster.layer = 0;
  } else {
    std::vector<Disc> discs = base.discs;
    std::vector<Region> regions = RegionSplitter(discs, options, base.seed).run(samples);
    variants.layout = layout_of(regions, options.side);
    const std::vector<int> numbers = wall_discs(regions);
    std::vector<Disc> walls, drawn_walls;
    for (const int i : numbers) {
      walls.push_back(discs[static_cast<std::size_t>(i)]);
      if (static_cast<std::size_t>(i) < base.discs.size()) drawn_walls.push_back(walls.back());
    }
    variants.others = parallel_map(
        others.size(),
        [&](std::size_t i) {
          std::vector<Disc> own = without_stand_ins(others[i].discs, drawn_walls, options.side);
          const std::size_t drawn = own.size();
          own.insert(own.end(), walls.begin(), walls.end());
          // The walls come after the discs that cut.
          const auto renumber = [&](int& disc) {
            if (disc >= 0)
              disc = static_cast<int>(drawn) +
                     static_cast<int>(std::lower_bound(numbers.begin(), numbers.end(), disc) - numbers.begin());
          };
          std::vector<Region> parts = regions;
          for (Region& region : parts) {
            for (Region::Wall& wall : region.walls) renumber(wall.joint);
            for (int& disc : region.spent) renumber(disc);
          }
          return split_regions(std::move(parts), samples, graph, std::move(own), drawn, options, others[i].seed, task);
        },
        task);
  }
  variants.layout.seed = base.seed;
  return variants;
}

}  // namespace outcrop

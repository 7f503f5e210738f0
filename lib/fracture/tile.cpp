#include "outcrop/fracture/tile.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "joint_laws.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"
#include "outcrop/fracture/clusters.h"
#include "outcrop/fracture/hull.h"
#include "outcrop/fracture/samples.h"
#include "overlap.h"
#include "tile_blocks.h"

namespace outcrop {
namespace {

constexpr double kLeastInradius = 0.4;  // Of the spacing: a thinner piece would be a blade between two samples.
constexpr double kLongest = 0.95;       // Of the side: a block as long as the tile would show its period.
constexpr std::size_t kOverlapProbes = 20'000;
constexpr int kMostPasses = 6;           // Of drawing and splitting, until sets have the intensity that was asked for.
constexpr double kNearIntensity = 0.03;  // Relative: near enough.
constexpr double kLeastChange = 0.1;     // Of a set's amount, to make up for growth …
constexpr double kMostChange = 4.0;      // … and for joints that end.

struct PlainHull {
  double volume = 0.0;
  std::size_t planes = 0;
};

void check(const TileOptions& options, double spacing) {
  require(std::isfinite(options.side) && options.side > 0.0, "side", "> 0 and finite", options.side);
  require(std::isfinite(options.spacing) && options.spacing >= 0.0, "spacing", "≥ 0 and finite", options.spacing);
  require(spacing > 0.0 && spacing <= options.side / 8.0, "spacing", "in (0, side / 8]", spacing);
  require(options.neighbour_factor >= 1.0 && options.neighbour_factor <= 4.0, "neighbour_factor", "in [1, 4]",
          options.neighbour_factor);
  require(options.neighbour_factor * spacing < options.side / 2.0, "neighbour_factor",
          "below half the side over the spacing", options.neighbour_factor);
  require(options.aperture >= 0.0 && options.aperture < spacing, "aperture", "≥ 0 and below the spacing",
          options.aperture);
  require(std::isfinite(options.rounding) && options.rounding >= 0.0, "rounding", "≥ 0 and finite", options.rounding);
  require(options.variants >= 1 && options.variants <= 256, "variants", "in 1 … 256", options.variants);
  require(options.blocks.empty() || options.variants == 1, "variants", "1 in a tile with authored blocks",
          options.variants);
  const std::string unfit = misfit(options.blocks, options.side);
  require(unfit.empty(), "blocks", "blocks that fit the tile", unfit);
  require(options.min_block_samples >= 1, "min_block_samples", "≥ 1", options.min_block_samples);
}

double area_of(const Polytope& shape, const Polytope::Face& face) {
  Vec3 twice{0.0};
  const Vec3& o = shape.vertices[face.loop[0]];
  for (std::size_t i = 2; i < face.loop.size(); ++i)
    twice += glm::cross(shape.vertices[face.loop[i - 1]] - o, shape.vertices[face.loop[i]] - o);
  return 0.5 * glm::length(twice);
}

std::vector<SetIntensity> intensities_of(const Clusters& clusters, const std::vector<Disc>& drawn,
                                         const std::vector<JointSet>& sets, double side) {
  const double volume = side * side * side;
  std::vector<SetIntensity> result(sets.size());
  for (std::size_t s = 0; s < sets.size(); ++s) {
    result[s].name = sets[s].name;
    if (is_measured(sets[s]))
      result[s].asked = (is_persistent(sets[s]) || sets[s].spacing == 0.0 ? 1.0 : sets[s].persistence) / mean_gap(sets[s]);
  }
  for (const Disc& disc : drawn)
    if (disc.set >= 0) result[static_cast<std::size_t>(disc.set)].drawn += kPi * disc.radius * disc.radius / volume;
  for (const Cluster& cluster : clusters.list)
    for (const Polytope::Face& face : cluster.shape.faces) {
      const int set = face.joint >= 0 ? clusters.discs[static_cast<std::size_t>(face.joint)].set : -1;
      // Each joint is the face of a block on either side.
      if (set >= 0) result[static_cast<std::size_t>(set)].made += 0.5 * area_of(cluster.shape, face) / volume;
    }
  return result;
}

struct Split {
  Clusters clusters;
  JointPattern pattern;     ///< That it was drawn from.
  std::vector<Disc> drawn;
  std::vector<SetIntensity> intensities;
};

// A disc grows until it parts its block, and ends where it would leave a chip: so the joints have another area than the
// discs. What sets with discs are short of or beyond is made up by drawing more or fewer.
Split split_as_asked(const std::vector<Vec3>& samples, const Graph& graph, JointPattern pattern,
                     const ClusterOptions& options, Seed seed, const Task& task) {
  const std::vector<JointSet> asked = pattern.sets;
  std::vector<double> change(asked.size(), 1.0);
  Split best;
  double least_error = 1e300;  // the largest of any set, as a logarithm
  for (int pass = 1; pass <= kMostPasses && least_error > kNearIntensity; ++pass) {
    Split split{.pattern = pattern, .drawn = draw_discs(pattern, options.side, seed, options.domain)};
    split.clusters = split_samples(samples, graph, split.drawn, options, seed, task);
    split.intensities = intensities_of(split.clusters, split.drawn, asked, options.side);
    double error = 0.0;
    for (std::size_t s = 0; s < asked.size(); ++s) {
      const SetIntensity& got = split.intensities[s];
      if (is_persistent(asked[s]) || got.asked == 0.0 || got.made == 0.0) continue;
      error = std::max(error, std::abs(std::log(got.made / got.asked)));
      change[s] = std::clamp(change[s] * got.asked / got.made, kLeastChange, kMostChange);
      pattern.sets[s].p32 = change[s] * asked[s].p32;
      pattern.sets[s].persistence = std::min(4.0, change[s] * asked[s].persistence);
    }
    if (error >= least_error) continue;
    least_error = error;
    best = std::move(split);
  }
  return best;
}

// The discs as they cut: with the normals of the faces along them, and once more for each further normal, to which those
// faces then refer.
std::vector<Disc> discs_as_cut(std::vector<Disc> discs, std::vector<Cluster>& clusters) {
  constexpr double kSameNormal = 1.0 - 1e-12;  // |cos|: some 1.4e-6 radians
  std::vector<std::vector<int>> versions(discs.size());
  for (Cluster& cluster : clusters)
    for (Polytope::Face& face : cluster.shape.faces) {
      if (face.joint < 0) continue;
      const auto drawn = static_cast<std::size_t>(face.joint);
      const Vec3& n = face.plane.normal;
      const auto same = std::find_if(versions[drawn].begin(), versions[drawn].end(), [&](int v) {
        return std::abs(glm::dot(discs[static_cast<std::size_t>(v)].normal, n)) > kSameNormal;
      });
      if (same != versions[drawn].end()) {
        face.joint = *same;
        continue;
      }
      const auto version = versions[drawn].empty() ? drawn : discs.size();
      if (version == discs.size()) discs.push_back(discs[drawn]);
      const double side = glm::dot(discs[drawn].normal, n) < 0.0 ? -1.0 : 1.0;
      if (std::abs(glm::dot(discs[version].normal, n)) <= kSameNormal) discs[version].normal = side * n;
      versions[drawn].push_back(static_cast<int>(version));
      face.joint = static_cast<int>(version);
    }
  return discs;
}

}  // namespace

Tile make_tile(const TileOptions& options, Seed seed, const Task& task) {
  const auto start = std::chrono::steady_clock::now();
  const double spacing = options.spacing > 0.0 ? options.spacing : options.side / kSpacingsPerSide;
  check(options, spacing);
  const bool is_own =
      !options.pattern.sets.empty() || !options.pattern.columns.empty() || !options.pattern.discs_at.empty();
  const JointPattern pattern = is_own ? options.pattern : joint_pattern(options.type, options.side);
  check_pattern(pattern, options.side);

  task.begin("fracture", 0);
  const std::vector<Vec3> samples = poisson_samples(options.side, spacing, seed, task);
  const double sight = options.neighbour_factor * spacing;
  const Graph graph = neighbour_graph(samples, options.side, sight);
  task.check();
  const bool is_torus = options.domain == Domain::Torus;
  const ClusterOptions cluster_options{
      .side = options.side,
      .sight = sight,
      .min_samples = options.min_block_samples,
      .min_inradius = std::max({kLeastInradius * spacing, options.aperture, 0.5 * pattern.least_thickness}),
      .covered_share = pattern.covered_share,
      .least_angle = pattern.least_angle,
      .longest = is_torus ? kLongest * options.side : 2.0 * options.side,
      .columns = pattern.columns,
      .sets = pattern.sets,
      .boxed_columns = options.variants > 1,
      .domain = options.domain};
  auto [clusters, drawn_pattern, drawn, intensities] = split_as_asked(samples, graph, pattern, cluster_options, seed, task);

  Tile tile;
  tile.side = options.side;
  tile.type = options.type;
  tile.aperture = options.aperture;
  tile.domain = options.domain;
  tile.sets = pattern.sets;
  tile.discs = discs_as_cut(clusters.discs, clusters.list);
  const auto blocks_of = [&](const Clusters& of) {
    return make_blocks(of.list, samples, options, spacing, task);
  };
  tile.blocks = blocks_of(clusters);
  tile.layout = TileLayout::lattice(options.side);
  if (options.variants > 1) {
    std::vector<Drawn> others;
    for (int i = 1; i < options.variants; ++i) {
      const Seed own = Rng(seed, "variants", static_cast<std::uint64_t>(i)).next();
      others.push_back({draw_discs(drawn_pattern, options.side, own, options.domain), own});
    }
    TileVariants variants = split_variants(samples, graph, {std::move(drawn), seed}, others, cluster_options, task);
    tile.layout = std::move(variants.layout);
    for (const Clusters& other : variants.others) {
      tile.others.push_back(blocks_of(other));
      for (Block& block : tile.others.back()) block.plane_joint.clear();
    }
  }
  if (tile.layout.layers.size() == 1)
    for (Block& block : tile.blocks) block.layer = 0;
  const std::vector<PlainHull> plain = parallel_map(
      clusters.list.size(),
      [&](std::size_t i) {
        if (clusters.list[i].positions.empty()) return PlainHull{};  // a column thinner than the samples can tell
        const BlockMesh hull = thick_hull(clusters.list[i].positions, spacing);
        return PlainHull{volume(hull), hull.triangles.size()};
      },
      task);

  TileStatistics& s = tile.statistics;
  const double cube = options.side * options.side * options.side;
  const auto blocks = static_cast<double>(tile.blocks.size());
  s.samples = samples.size();
  s.discs = clusters.discs.size();
  s.intensities = std::move(intensities);
  s.clusters = clusters.list.size();
  s.merged_chips = clusters.stopped_joints;
  s.added_joints = clusters.added_joints;
  s.largest_bend = clusters.largest_bend;
  for (const Block& block : tile.blocks) {
    s.filled_share += block.volume / cube;
    s.mean_planes += static_cast<double>(block.planes.size()) / blocks;
    s.max_planes = std::max(s.max_planes, block.planes.size());
  }
  for (const PlainHull& hull : plain) {
    s.plain_filled_share += hull.volume / cube;
    s.plain_mean_planes += static_cast<double>(hull.planes) / blocks;
    s.plain_max_planes = std::max(s.plain_max_planes, hull.planes);
  }
  s.overlap_share = overlap_share(tile, kOverlapProbes, seed);
  s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return tile;
}

}  // namespace outcrop

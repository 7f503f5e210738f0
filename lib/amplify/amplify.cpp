#include "outcrop/amplify/amplify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "outcrop/core/error.h"
#include "outcrop/core/rng.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/terrain/terrain_field.h"
#include "outcrop/tiles/bedded_rock.h"
#include "outcrop/tiles/finer_joints.h"
#include "outcrop/tiles/large_fractures.h"
#include "outcrop/tiles/replication.h"
#include "rock_zone.h"

namespace outcrop {
namespace {

constexpr double kReachInBlocks = 1.8;       // Mean block sizes; recess 1 hides the base behind whole blocks.
constexpr double kRasterPerReach = 64.0;     // Nodes of the rock zone's raster across its reach: rims lose two of them …
constexpr double kRasterNodes = 24e6;        // … but no more than this many in all: 5.4 bytes each, two layers.
constexpr double kPlaceableShare = 0.7;      // Of a tile's volume; below that, its blocks are too small for the resolution.
constexpr double kCellsInSmallestBlock = 2.0;  // Design decision 10.
constexpr double kClosureSlope = 0.05;       // Blocks grow by this much a metre below the crack floor.
constexpr double kBlocksPerSide = 5.0;       // Of a tile, about: what a finer tile is judged by before it is made.
constexpr double kFinerDepth = 0.25;         // Of its blocks: how deep a finer joint cuts into a coarse block.
constexpr double kFinerFloor = 1.0;          // Coarse blocks below the original surface: finer cracks close from there.
constexpr double kCapInBlocks = 0.1;         // How far from blocks their field knows its value.
constexpr double kFarthestBody = 1e4;        // Metres: presence asks how far away a body is.
constexpr std::size_t kMostFaults = 64;  // Of the large fractures, that displace strata: the largest.
constexpr int kCoverageProbes = 2000;
constexpr double kProbePrecision = 0.01;       // Of a step of the search for the surface.

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The terrain with the strata's materials as labels.
class StratifiedTerrain final : public Field {
 public:
  StratifiedTerrain(FieldPtr terrain, Strata strata) : terrain_(std::move(terrain)), strata_(std::move(strata)) {}
  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    terrain_->values(points, values, gradients);
  }
  [[nodiscard]] double lipschitz() const noexcept override { return terrain_->lipschitz(); }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override { return terrain_->bound(box); }
  void labels(const Points& points, std::span<Label> labels) const noexcept override {
    for (std::size_t i = 0; i < points.size(); ++i) labels[i] = strata_.material(points[i]);
  }

 private:
  FieldPtr terrain_;
  Strata strata_;
};

/// The horizontal distance to missing data: intersected with a solid it leaves holes.
class HoleField final : public Field {
 public:
  explicit HoleField(Heightfield heightfield) : heightfield_(std::move(heightfield)) {}
  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Heightfield::Sample hole = heightfield_.hole_at(points.x[i], points.y[i]);
      values[i] = hole.h;
      if (!gradients.empty()) gradients[i] = Vec3(hole.hx, hole.hy, 0.0);
    }
  }
  [[nodiscard]] double lipschitz() const noexcept override { return std::sqrt(2.0); }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    return heightfield_.hole_bound(Vec2(box.lo), Vec2(box.hi));
  }

 private:
  Heightfield heightfield_;
};

struct MadeRock {
  Tile tile;
  double aperture = 0.0, rounding = 0.0;
  double block_size = 0.0;  ///< Cube root of the mean block volume.
  double reach = 0.0;       ///< Of the ground behind and before its blocks; 0 when it is not placeable.
  bool placeable = false;   ///< Large enough for the resolution.
};

/// The criterion where faults set the surface back or forth: an anchor is as far from it as it would be without them.
Criterion stepped(Criterion criterion, const std::vector<LargeFracture>& fractures) {
  std::vector<LargeFracture> faults;
  std::ranges::copy_if(fractures, std::back_inserter(faults), [](const LargeFracture& f) { return f.step != 0.0; });
  if (faults.empty()) return criterion;
  return [criterion = std::move(criterion), faults = std::move(faults)](const Anchor& anchor) {
    Anchor moved = anchor;
    moved.distance += setback(faults, anchor.position);
    return criterion(moved);
  };
}

/// Gaps narrower than two cells would be scattered holes in a mesh.
std::vector<LargeFracture> wide_enough(std::vector<LargeFracture> fractures, double resolution) {
  std::erase_if(fractures, [&](const LargeFracture& f) { return f.width < kCellsInSmallestBlock * resolution; });
  return fractures;
}

double mean_volume(const Tile& tile) {
  double sum = 0.0;
  for (const Block& block : tile.blocks) sum += block.volume;
  return sum / static_cast<double>(std::max<std::size_t>(tile.blocks.size(), 1));
}

MadeRock make_rock(const TileOptions& tile, const AmplifyOptions& options, Seed seed, const Task& task) {
  MadeRock rock{.tile = make_tile(tile, seed, task), .aperture = tile.aperture, .rounding = tile.rounding};
  rock.block_size = std::cbrt(mean_volume(rock.tile));
  double all = 0.0, large = 0.0;
  for (const Block& block : rock.tile.blocks) {
    all += block.volume;
    if (2.0 * block.inradius >= kCellsInSmallestBlock * options.resolution) large += block.volume;
  }
  rock.placeable = large >= kPlaceableShare * all;
  return rock;
}

/// The rock that cuts a material's blocks again; not placeable where there is none or the resolution cannot show it.
MadeRock make_finer_rock(const StrataFile& file, const RockMaterial& material, const AmplifyOptions& options, Seed seed,
                         const Task& task) {
  if (!material.finer) return {};
  const double side = material.finer->tile_side;
  if (side < kBlocksPerSide * kCellsInSmallestBlock * options.resolution) return {};
  return make_rock(tile_in_place(file, *material.finer, side), options, Rng(seed, "finer joints").next(), task);
}

/// By how much blocks grow: cracks narrower than two cells are welded, since a mesh would show them as scattered holes.
double swelling_of(const MadeRock& rock, double resolution) {
  return 0.5 * rock.aperture * std::clamp(2.0 - rock.aperture / resolution, 0.0, 1.0) * (1.0 + 1e-3);
}

/// Half the crack, and the grooves that rounding leaves along edges (at most R/3 where three faces meet).
double closure_of(const MadeRock& rock) { return 0.5 * rock.aperture + 0.34 * rock.rounding; }

Warp make_warp(const RockMaterial& material, double side, double resolution) {
  const RockRelief measures = rock_relief(material, side);
  if (measures.amplitude == 0.0) return {};
  const ReliefPtr relief = read_relief(material.relief.empty() ? find_relief("rough") : material.relief, measures.period);
  return {std::make_shared<Relief>(relief->smoothed(2.0 * resolution)), measures.amplitude};
}

RockReport report_of(const RockMaterial& material, const MadeRock& rock, const Mat3& map_from_tile,
                     const AmplifyOptions& options, const Task& task) {
  RockReport report{.material = material.name, .type = rock.tile.type, .tile = rock.tile.statistics};
  if (options.measure) report.measured = tile_report(rock.tile, material.name, {}, map_from_tile, task);
  report.tile_blocks = rock.tile.blocks.size();
  for (const Block& block : rock.tile.blocks) {
    report.block_volumes.push_back(block.volume);
    report.block_faces.push_back(block.planes.size());
    report.block_sizes.push_back(block.bounds.size());
  }
  return report;
}

/// How much rock the rules of the placement and of the materials allow.
class Rules {
 public:
  Rules(const StrataFile& file, const Heightfield& heightfield, double block_size) {
    const auto bind = [&](const std::optional<PlacementRule>& rule) {
      return rule ? rule_value(*rule, heightfield, block_size) : RuleValue();
    };
    everywhere_ = bind(file.placement.where);
    for (const RockMaterial& material : file.materials) of_material_.push_back(bind(material.where));
  }
  [[nodiscard]] bool any_of_place() const { return everywhere_ != nullptr; }
  [[nodiscard]] bool any_of_rock() const {
    return std::ranges::any_of(of_material_, [](const RuleValue& rule) { return rule != nullptr; });
  }
  [[nodiscard]] double of_place(const RuleSite& site) const { return everywhere_ ? everywhere_(site) : 1.0; }
  [[nodiscard]] double of_rock(const RuleSite& site) const {
    const RuleValue& rule = of_material_[site.material];
    return rule ? rule(site) : 1.0;
  }

 private:
  RuleValue everywhere_;
  std::vector<RuleValue> of_material_;
};

/// What placing blocks of any rock needs to know.
struct PlacedScene {
  const StrataFile& file;
  const Strata& strata;
  const AmplifyOptions& options;
  const RockZone& zone;
  const Rules& rules;
  const std::vector<LargeFracture>& fractures;
  FieldPtr terrain, stratified;
  Box domain;
  Vec2 corner{0.0};  ///< South-west, of the terrain.
  FieldPtr base = displaced_terrain(terrain, zone.recess, 1.0);
  FieldPtr clip = displaced_terrain(terrain, zone.advance, -1.0);

  [[nodiscard]] bool visible(const Box& box) const {
    const Vec2 a(box.lo), b(box.hi);
    if (zone.recess.bound(a, b).hi <= 0.0 && zone.advance.bound(a, b).hi <= 0.0) return false;
    return base->bound(box).hi > 0.0 && clip->bound(box).lo < 0.0;
  }

  /// The blocks of a finer rock everywhere where those of a limb may be seen. None is left out, however small: what is
  /// missing would be a hole in a coarse block.
  [[nodiscard]] std::shared_ptr<const Replication> finer_blocks(const RockMaterial& material, const MadeRock& finer,
                                                                Label label, const Mat3& world_from_tile,
                                                                const FieldPtr& body, const FieldPtr& crack_floor,
                                                                const Task& task) const {
    return std::make_shared<Replication>(
        Rock{.tile = finer.tile,
             .warp = make_warp(material, finer.tile.side, options.resolution),
             .label = label,
             .world_from_tile = world_from_tile,
             .origin = Vec3(corner, 0.0)},
        stratified,
        ReplicationOptions{
            .domain = domain,
            .visible = [this, body](const Box& box) { return (!body || body->bound(box).lo < 0.0) && visible(box); },
            .crack_floor = crack_floor,
            .closure = closure_of(finer),
            .closure_slope = kClosureSlope,
            .swelling = swelling_of(finer, options.resolution),
            .cap = kCapInBlocks * finer.block_size},
        task);
  }

  /// The blocks of one rock, by the limbs of the folds; what they count goes to `report`.
  [[nodiscard]] std::vector<FieldPtr> place(Label label, MadeRock rock, const MadeRock& finer, RockReport& report,
                                            const Task& task) const {
    const Placement& placement = file.placement;
    const RockMaterial& material = file.materials[label];
    const Mat3 bedding_from_tile = glm::transpose(file.strata.world_from_bedding()) * world_from_tile(file);
    const double size = rock.block_size, aperture = rock.aperture;
    const Warp warp = make_warp(material, rock.tile.side, options.resolution);
    const double swelling = swelling_of(rock, options.resolution);
    // So many block sizes below the original surface.
    const auto floor_at = [&](double blocks) {
      const double share = placement.recess > 0.0 ? blocks / (kReachInBlocks * placement.recess) : 0.0;
      return displaced_terrain(terrain, zone.recess, share);
    };
    const FieldPtr crack_floor = floor_at(placement.crack_depth);
    const FieldPtr finer_floor = finer.placeable ? floor_at(std::max(kFinerFloor, placement.crack_depth)) : nullptr;
    std::vector<FieldPtr> placed;
    for (const Strata::Limb& limb : strata.limbs()) {
      const FieldPtr body = stratum_body(strata, label, limb, kFarthestBody, kFarthestBody);
      ReplicationOptions replication{
          .domain = domain,
          .criterion = stepped(all_of({distance_between(placement.distance_lo * size, placement.distance_hi * size),
                                       slope_at_least(placement.slope)}),
                               fractures),
          .body = body,
          .seed = options.seed + label,
          .slope = [this](const Vec3& p) { return zone.nearby.at(p.x, p.y).h > 0.0 ? 0.5 * kPi : 0.0; },
          .visible = [this, body](const Box& box) { return (!body || body->bound(box).lo < 0.0) && visible(box); },
          .crack_floor = crack_floor,
          .closure = closure_of(rock),
          .closure_slope = kClosureSlope,
          .swelling = swelling,
          .min_inradius = 0.5 * kCellsInSmallestBlock * options.resolution,
          .cap = kCapInBlocks * size};
      if (zone.weighted)
        replication.weight = [this, label](const Anchor& anchor) {
          const Vec2 ground = zone.ground.at(Vec2(anchor.position));
          const RuleSite site{
              .position = anchor.position, .ground = ground, .distance = anchor.distance, .material = label};
          return zone.rim.at(ground.x, ground.y).h * std::min(rules.of_place(site), rules.of_rock(site));
        };
      const Mat3 world_from_tile = limb.world_from_bedding * bedding_from_tile;
      auto node = std::make_shared<Replication>(Rock{.tile = rock.tile,
                                                     .warp = warp,
                                                     .label = label,
                                                     .world_from_tile = world_from_tile,
                                                     .origin = Vec3(corner, 0.0)},
                                                stratified, std::move(replication), task);
      report.replicated_blocks += node->block_count();
      report.bytes += node->tile_bytes();
      if (node->block_count() == 0) continue;
      FieldPtr blocks = std::move(node);
      if (finer.placeable) {
        const auto joints = finer_blocks(*material.finer, finer, label, world_from_tile, body, finer_floor, task);
        report.finer_blocks += joints->block_count();
        report.bytes += joints->tile_bytes();
        // The surface that blocks are cut off at shows joints like their own.
        blocks = with_finer_joints(bedded_rock(std::move(blocks), clip, {}), joints, kFinerDepth * finer.block_size);
      }
      const FieldPtr cut = stratum_body(strata, label, limb, 2.0 * size, 2.0 * kCapInBlocks * size);
      if (cut) blocks = bedded_rock(std::move(blocks), cut, {0.5 * aperture - swelling, crack_floor, kClosureSlope});
      placed.push_back(std::move(blocks));
    }
    return placed;
  }
};

/// Walks along the input surface's normal, outwards from rock and inwards from air, to the surface of the result, and asks
/// whose it is. Opposite walls of a gully are not mistaken for it.
void measure(Amplified& result, const Field& rock, const Heightfield& heightfield, const RockZone& zone, double reach,
             Seed seed) {
  const Vec2 lo(result.region.lo), hi(result.region.hi);
  const double threshold = std::cos(zone.slope);
  int probes = 0, on_blocks = 0;
  double offset = 0.0;
  for (int i = 0; i < kCoverageProbes * 50 && probes < kCoverageProbes; ++i) {
    Rng rng(seed, "coverage", static_cast<std::uint64_t>(i));
    const double x = rng.uniform(lo.x, hi.x);
    const double y = rng.uniform(lo.y, hi.y);
    if (heightfield.has_holes() && heightfield.hole_distance(x, y) > 0.0) continue;
    if (zone.weighted && zone.weight.at(x, y).h < 1.0) continue;
    const double h = -result.terrain->value({x, y, 0.0});
    const Vec3 p(x, y, h);
    const Vec3 n = glm::normalize(result.terrain->gradient(p));
    if (n.z > threshold) continue;
    ++probes;
    // The first rock inwards, or the last outwards.
    const auto is_rock = [&](double t) { return result.field->value(p + t * n) < 0.0; };
    const double step = 0.02 * reach;
    double t = 0.0;
    if (is_rock(t)) {
      while (t < reach && is_rock(t + step)) t += step;
    } else {
      while (t > -2.0 * reach && !is_rock(t)) t -= step;
    }
    for (double half = 0.5 * step; half > kProbePrecision * step; half *= 0.5)
      if (is_rock(t + half)) t += half;
    // Blocks are the surface where their value is the field's own.
    const Vec3 q = p + t * n;
    if (rock.value(q) <= result.field->value(q)) ++on_blocks;
    offset += t;
  }
  if (probes == 0) return;
  result.rock_coverage = static_cast<double>(on_blocks) / probes;
  result.mean_offset = offset / probes;
}

}  // namespace

Amplified amplify(const Heightfield& heightfield, const StrataFile& strata_file, const AmplifyOptions& options, const Task& task) {
  require(options.resolution > 0.0, "resolution", "> 0 m", options.resolution);
  const Vec2 lo = glm::max(options.region_lo, heightfield.lo());
  const Vec2 hi = glm::min(options.region_hi, heightfield.hi());
  require(lo.x < hi.x && lo.y < hi.y, "region", "a rectangle that overlaps the terrain", "one outside of it or without area");

  // Tiles.
  auto start = std::chrono::steady_clock::now();
  Amplified result;
  const double default_side = default_tile_side(heightfield);
  const std::size_t material_count = strata_file.materials.size();
  std::vector<char> used(material_count, 0);
  Strata strata = strata_on(strata_file, heightfield);
  const Interval relief = heightfield.height_bound(lo, hi);
  const std::vector<LargeFracture> fractures =
      large_fractures_on(strata_file.large_fractures, heightfield, {Vec3(lo, relief.lo), Vec3(hi, relief.hi)}, options.seed);
  const std::vector<Fault> faults = faults_of(fractures, kMostFaults);
  strata.faults.insert(strata.faults.end(), faults.begin(), faults.end());
  if (strata.layers.empty()) used[0] = 1;
  for (const Stratum& layer : strata.layers) used[layer.material] = 1;
  for (const Label material : strata.map.materials()) used[material] = 1;
  std::vector<MadeRock> rocks(material_count), finer_rocks(material_count);
  double reach = 0.0;
  for (std::size_t m = 0; m < material_count; ++m) {
    const RockMaterial& material = strata_file.materials[m];
    result.label_names.push_back(material.name);
    result.label_colours.push_back(material.colour);
    if (!used[m]) continue;
    task.check();
    rocks[m] = make_rock(tile_in_place(strata_file, m, default_side), options, options.seed + m, task);
    result.rocks.push_back(report_of(material, rocks[m], world_from_tile(strata_file), options, task));
    result.mean_block_size = std::max(result.mean_block_size, rocks[m].block_size);
    if (!rocks[m].placeable) continue;
    rocks[m].reach = kReachInBlocks * rocks[m].block_size;
    reach = std::max(reach, rocks[m].reach);
    finer_rocks[m] = make_finer_rock(strata_file, material, options, options.seed + m, task);
  }
  const Label ground = static_cast<Label>(material_count);
  result.label_names.push_back("ground");
  result.label_colours.push_back(strata_file.ground_colour);
  result.tile_seconds = seconds_since(start);

  // Terrain, strata and the zone where rock may stand.
  start = std::chrono::steady_clock::now();
  const auto filled = std::make_shared<TerrainField>(heightfield, NodataPolicy::Fill);
  const auto stratified = std::make_shared<StratifiedTerrain>(filled, strata);
  const Placement& placement = strata_file.placement;
  FieldPtr rock_field;
  RockZone zone{.slope = placement.slope};
  const double margin = 2.0 * reach * std::max(1.0, placement.recess);
  const Vec2 zone_extent = hi - lo + 2.0 * margin;
  const double spacing = std::max(reach / kRasterPerReach, std::sqrt(zone_extent.x * zone_extent.y / kRasterNodes));
  const double largest_block = reach / kReachInBlocks;
  const Rules rules(strata_file, heightfield, std::max(largest_block, options.resolution));
  const auto surface = [&](const Vec3& p) {
    return RuleSite{.position = p, .ground = Vec2(p), .distance = {}, .material = strata.material(p)};
  };
  std::function<double(const Vec3&)> weight_at, rock_weight_at;
  if (rules.any_of_place()) weight_at = [&](const Vec3& p) { return rules.of_place(surface(p)); };
  if (rules.any_of_rock()) rock_weight_at = [&](const Vec3& p) { return rules.of_rock(surface(p)); };
  if (reach > 0.0)
    zone = make_rock_zone(heightfield,
                          {.lo = lo - margin,
                           .hi = hi + margin,
                           .slope = placement.slope,
                           .reach = reach,
                           .recess = placement.recess,
                           .reach_at = [&](const Vec3& p) { return rocks[strata.material(p)].reach; },
                           .spacing = spacing,
                           .block_size = largest_block,
                           .weight_at = weight_at,
                           .rock_weight_at = rock_weight_at,
                           .rim = placement.rim * largest_block},
                          task);

  FieldPtr field = labelled(filled, ground);
  const Interval heights = heightfield.height_bound(lo, hi);
  double top = heights.hi;
  if (!zone.empty) {
    const PlacedScene scene{.file = strata_file,
                            .strata = strata,
                            .options = options,
                            .zone = zone,
                            .rules = rules,
                            .fractures = fractures,
                            .terrain = filled,
                            .stratified = stratified,
                            .domain = {Vec3(lo - reach, heights.lo - 2.0 * margin), Vec3(hi + reach, heights.hi + margin)},
                            .corner = heightfield.lo()};
    std::vector<FieldPtr> placed;
    std::size_t report = 0;
    for (std::size_t m = 0; m < material_count; ++m) {
      if (!used[m]) continue;
      RockReport& rock_report = result.rocks[report++];
      if (!rocks[m].placeable) continue;
      std::ranges::move(scene.place(static_cast<Label>(m), std::move(rocks[m]), finer_rocks[m], rock_report, task),
                        std::back_inserter(placed));
    }
    if (!placed.empty()) rock_field = union_of(std::move(placed));
    field = rock_on_terrain(filled, zone, rock_field, stratified, ground);
    const double depth = strata_file.large_fractures.depth;
    if (depth > 0.0)
      field = with_gaps(std::move(field), wide_enough(fractures, options.resolution),
                        {.floor = displaced_terrain(filled, zone.recess, depth), .taper = depth * reach,
                         .untouched = [zone](const Box& box) {
                           return zone.recess.bound(Vec2(box.lo), Vec2(box.hi)).hi <= 0.0 &&
                                  zone.advance.bound(Vec2(box.lo), Vec2(box.hi)).hi <= 0.0;
                         }});
    top = heights.hi + reach;
  }
  result.terrain = filled;
  result.ground = field;
  const bool holes = heightfield.has_holes() && strata_file.nodata == NodataPolicy::Hole;
  if (holes) {
    result.hole = std::make_shared<HoleField>(heightfield);
    field = intersection_of({field, labelled(result.hole, ground)});
  }
  result.field = std::move(field);

  const double floor = std::max({1.5 * margin, 4.0 * options.resolution, 0.02 * std::max(hi.x - lo.x, hi.y - lo.y)});
  result.region = {Vec3(lo, heights.lo - floor), Vec3(hi, top + 2.0 * options.resolution)};
  if (rock_field) {
    task.begin("measuring the rock", 0);
    measure(result, *rock_field, heightfield, zone, reach, options.seed);
  }
  result.placement_seconds = seconds_since(start);
  return result;
}

}  // namespace outcrop

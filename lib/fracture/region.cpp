#include "region.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "joint_laws.h"
#include "lattice.h"

namespace outcrop {
namespace {

constexpr int kLongestPeriod = 9;  // |w|² of the periods along which a slab may close.
constexpr double kLargestBend = 30.0 * kPi / 180.0;  // Radians; beyond it a joint is added instead.
constexpr double kBeddingBend = 20.0 * kPi / 180.0;  // Radians between a slab's normal and a joint that runs along it.
constexpr double kBeddingRadius = 0.75;              // Of the side: wider joints cross the whole tile.
constexpr double kSameSize = 0.5;   // Discs of at least this share of the largest radius may close a region.
constexpr double kSteepest = 0.82;  // |cos| between the walls of a rod: about 35°.
constexpr double kAcross = 0.5;     // |cos| between a rod's direction and the normal that cuts it.

int gcd(int a, int b) { return b == 0 ? std::abs(a) : gcd(b, a % b); }

// The shortest k with m · k = 1.
IVec3 step_across(const IVec3& m) {
  for (const IVec3& k : small_vectors())
    if (dot(m, k) == 1) return k;
  assert(false);
  return {0, 0, 1};
}

// Two short whole vectors that span all whole vectors at right angles to m.
std::vector<IVec3> plane_basis(const IVec3& m) {
  for (const IVec3& v : small_vectors())
    for (const IVec3& u : small_vectors()) {
      if (dot(u, u) > dot(v, v)) break;
      if (cross(u, v) == m) return {u, v};
    }
  assert(false);
  return {};
}

double angle(double cosine) { return std::acos(std::clamp(std::abs(cosine), 0.0, 1.0)); }

// How far a disc reaches along a direction.
double extent(const Disc& disc, const Vec3& direction) {
  const double c = glm::dot(disc.normal, direction);
  return disc.radius * std::sqrt(std::max(0.0, 1.0 - c * c));
}

// The least cost among the oldest of the largest candidates: large joints come first without a detour for the very
// largest.
template <class Candidate>
const Candidate* best_of(const std::vector<Candidate>& candidates) {
  double largest = 0.0;
  for (const Candidate& c : candidates) largest = std::max(largest, c.radius);
  const Candidate* best = nullptr;
  for (const Candidate& c : candidates)
    if (c.radius >= kSameSize * largest &&
        (!best || c.age < best->age || (c.age == best->age && c.cost < best->cost)))
      best = &c;
  return best;
}

}  // namespace

RegionSplitter::RegionSplitter(std::vector<Disc>& discs, const ClusterOptions& options, Seed seed)
    : discs_(discs), options_(options), seed_(seed) {
  for (int i = 0; i < static_cast<int>(discs.size()); ++i)
    if (discs[static_cast<std::size_t>(i)].age >= 0) candidates_.push_back(i);
  for (std::size_t s = 0; s < options.sets.size(); ++s) {
    closers_.push_back(draw_closer(s));
    if (is_persistent(options.sets[s])) candidates_.push_back(kFirstCloser - static_cast<int>(s));
  }
}

std::vector<Region> RegionSplitter::run(const std::vector<Vec3>& samples) {
  Region whole;
  whole.positions = samples;
  whole.samples.resize(samples.size());
  for (std::uint32_t i = 0; i < samples.size(); ++i) whole.samples[i] = i;
  if (options_.domain == Domain::Box) {
    for (const Polytope::Face& face : box_polytope({Vec3(0.0), Vec3(options_.side)}).faces)
      whole.walls.push_back({face.plane, kWall});
    return {std::move(whole)};
  }
  std::vector<Region> rods;
  if (!options_.columns.empty()) {
    rods = column_regions(samples, options_.side, options_.columns, options_.boxed_columns, seed_);
  } else {
    whole.periods = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (Region& slab : bedded(close(std::move(whole), torus_closing()))) {
      const Closing closing = slab_closing(slab);
      rods.push_back(close(std::move(slab), closing));
    }
  }
  std::vector<Region> cells;
  for (Region& rod : rods) {
    if (!rod.periods.empty()) {
      const Closing closing = rod_closing(rod);
      rod = close(std::move(rod), closing);
    }
    cells.push_back(std::move(rod));
  }
  return cells;
}

const Disc& RegionSplitter::candidate(int i) const {
  return i >= 0 ? discs_[static_cast<std::size_t>(i)] : closers_[static_cast<std::size_t>(kFirstCloser - i)];
}

// A persistent joint of a set anywhere in the tile.
Disc RegionSplitter::draw_closer(std::size_t set) {
  Rng rng(seed_, "persistent joints that close", drawn_closers_++);
  Disc disc{.radius = kPersistentRadius * options_.side, .set = static_cast<int>(set)};
  for (int axis = 0; axis < 3; ++axis) disc.centre[axis] = options_.side * rng.uniform();
  disc.normal = draw_normal(options_.sets[set], rng);
  disc.age = joint_ages(options_.sets)[set];
  return disc;
}

// The index of the disc that a candidate stands for; a closer joins the discs, and another takes its place.
int RegionSplitter::take(int i) {
  if (i > kFirstCloser) return i;
  const auto set = static_cast<std::size_t>(kFirstCloser - i);
  discs_.push_back(closers_[set]);
  closers_[set] = draw_closer(set);
  return static_cast<int>(discs_.size()) - 1;
}

// Whether the joints of a persistent set part all other persistent ones.
bool RegionSplitter::others_end_at(std::size_t set) const {
  return std::all_of(options_.sets.begin(), options_.sets.end(), [&](const JointSet& other) {
    if (!is_persistent(other) || &other == &options_.sets[set]) return true;
    return other.ends_share == 1.0 &&
           std::find(other.ends_at.begin(), other.ends_at.end(), options_.sets[set].name) != other.ends_at.end();
  });
}

bool RegionSplitter::is_spent(const Region& region, int disc) const {
  return std::find(region.spent.begin(), region.spent.end(), disc) != region.spent.end();
}

// A plane closes on the torus when its normal is a whole vector m; it passes the tile |m| times, so that short m are
// better.
RegionSplitter::Closing RegionSplitter::torus_closing() {
  struct Candidate {
    double cost, radius;
    int age, disc;
    IVec3 m;
    double bend;
  };
  std::vector<Candidate> candidates;
  for (const int i : candidates_)
    for (const IVec3& m : primitive_vectors()) {
      const Disc& disc = candidate(i);
      const double bend = angle(glm::dot(disc.normal, unit(m)));
      if (bend <= kLargestBend)
        candidates.push_back({bend + kLengthPenalty * (std::sqrt(dot(m, m)) - 1.0), disc.radius, disc.age, i, m, bend});
    }
  Closing closing;
  IVec3 m{0, 0, 1};
  if (const Candidate* best = best_of(candidates)) {
    m = best->m;
    closing.centre = candidate(best->disc).centre;
    closing.joint = take(best->disc);
    closing.bend = best->bend;
  } else {
    Rng rng = added_stream();
    closing.centre.z = options_.side * rng.uniform();
  }
  closing.normal = unit(m);
  closing.step = step_across(m);
  closing.periods = plane_basis(m);
  return closing;
}

// In a slab a plane closes when it holds one period w: its normal is turned at right angles to w, no further.
RegionSplitter::Closing RegionSplitter::slab_closing(const Region& slab) {
  struct Candidate {
    double cost, radius;
    int age, disc;
    Vec3 normal, centre;
    IVec3 w, step;
    double bend;
  };
  const Plane& floor = slab.walls[0].plane;  // floor and ceiling: opposite normals
  const Plane& ceiling = slab.walls[1].plane;
  const IVec3 across = step_across(cross(slab.periods[0], slab.periods[1]));
  const double pitch = options_.side * std::abs(glm::dot(Vec3(across), ceiling.normal));
  struct Way {
    IVec3 w, step;
  };
  std::vector<Way> ways;
  for (int a = 0; a <= 2; ++a)
    for (int b = a == 0 ? 1 : -2; b <= 2; ++b) {
      if (gcd(a, b) != 1) continue;
      const IVec3 w = a * slab.periods[0] + b * slab.periods[1];
      if (dot(w, w) > kLongestPeriod) continue;
      for (int c = -2; c <= 2; ++c)
        for (int d = -2; d <= 2; ++d)
          if (a * d - b * c == 1) {
            ways.push_back({w, c * slab.periods[0] + d * slab.periods[1]});
            c = d = 3;  // any complement will do: they differ by w
          }
    }

  std::vector<Candidate> candidates;
  for (const int i : candidates_) {
    const Disc& disc = candidate(i);
    if (is_spent(slab, i)) continue;
    const double middle = 0.5 * (ceiling.distance(disc.centre) - floor.distance(disc.centre));
    const double turns =
        -std::floor(middle / pitch + 0.5) * (glm::dot(Vec3(across), ceiling.normal) > 0.0 ? 1.0 : -1.0);
    const Vec3 centre = disc.centre + options_.side * turns * Vec3(across);
    if (std::max(ceiling.distance(centre), floor.distance(centre)) > extent(disc, ceiling.normal)) continue;
    for (const Way& way : ways) {
      const Vec3 along = unit(way.w);
      const Vec3 flat = disc.normal - glm::dot(disc.normal, along) * along;
      const double length = glm::length(flat);
      const double bend = angle(length);
      if (bend > kLargestBend || std::abs(glm::dot(flat / length, ceiling.normal)) > kSteepest) continue;
      candidates.push_back({bend + kLengthPenalty * (glm::length(Vec3(way.w)) - 1.0), disc.radius, disc.age, i,
                            flat / length, centre, way.w, way.step, bend});
    }
  }
  Closing closing;
  if (const Candidate* best = best_of(candidates)) {
    closing = {best->normal, best->centre, best->step, {best->w}, take(best->disc), best->bend};
  } else {
    // A joint across the slab, along its shortest period or the other.
    Rng rng = added_stream();
    const bool first = rng.uniform() < 0.5;
    closing.periods = {slab.periods[first ? 0 : 1]};
    closing.step = slab.periods[first ? 1 : 0];
    closing.normal = glm::normalize(glm::cross(ceiling.normal, Vec3(closing.periods[0])));
    closing.centre = options_.side * rng.uniform() * Vec3(closing.step);
  }
  return closing;
}

// Across a rod any plane closes.
RegionSplitter::Closing RegionSplitter::rod_closing(const Region& rod) {
  struct Candidate {
    double cost, radius;
    int age, disc;
    Vec3 centre;
  };
  const IVec3 w = rod.periods[0];
  const Vec3 along = unit(w);
  std::vector<Plane> planes;
  for (const Region::Wall& wall : rod.walls) planes.push_back(wall.plane);
  const Vec3 start = -planes[0].offset * planes[0].normal;
  const Vec3 middle = inscribed_ball(planes, start, options_.side).centre;

  std::vector<Candidate> candidates;
  for (const int i : candidates_) {
    const Disc& disc = candidate(i);
    const double across = std::abs(glm::dot(disc.normal, along));
    if (is_spent(rod, i) || across < kAcross) continue;
    const Vec3 nearest = middle + wrapped_difference(middle, disc.centre, options_.side);
    // One image of each class of shifts that w does not join.
    double deepest = 0.0;
    std::optional<Vec3> centre;
    for (int z = -2; z <= 2; ++z)
      for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) {
          const IVec3 shift(x, y, z);
          if (dot(shift, w) < 0 || dot(shift, w) >= dot(w, w)) continue;
          const Vec3 image = nearest + options_.side * Vec3(shift);
          double depth = 1e300;
          for (const Plane& plane : planes)
            depth = std::min(depth, 0.5 * extent(disc, plane.normal) - plane.distance(image));
          if (depth > deepest) {
            deepest = depth;
            centre = image;
          }
        }
    if (centre) candidates.push_back({-across, disc.radius, disc.age, i, *centre});
  }
  Closing closing;
  if (const Candidate* best = best_of(candidates)) {
    closing.normal = candidate(best->disc).normal;
    closing.centre = best->centre;
    closing.joint = take(best->disc);
  } else {
    Rng rng = added_stream();
    constexpr double kTilt = 150.0;  // Fisher concentration about the rod's direction: some 7°.
    closing.centre = middle + options_.side * rng.uniform() * Vec3(w);
    closing.normal = fisher_direction(along, kTilt, rng);
  }
  closing.step = w;
  return closing;
}

// The part between the plane and its next image; samples move there by whole steps.
Region RegionSplitter::close(Region region, const Closing& closing) {
  Vec3 normal = closing.normal;
  if (glm::dot(normal, Vec3(closing.step)) < 0.0) normal = -normal;
  const double offset = glm::dot(normal, closing.centre);
  const double pitch = options_.side * glm::dot(normal, Vec3(closing.step));
  for (Vec3& p : region.positions)
    p -= std::floor((glm::dot(normal, p) - offset) / pitch) * options_.side * Vec3(closing.step);
  region.walls.push_back({{-normal, offset}, closing.joint});
  region.walls.push_back({{normal, -offset - pitch}, closing.joint});
  if (region.periods.size() == 1) region.axis = region.periods[0];
  region.periods = closing.periods;
  if (closing.joint >= 0) region.spent.push_back(closing.joint);
  largest_bend_ = std::max(largest_bend_, closing.bend);
  return region;
}

// Joints about as wide as the tile that run along a slab are bedding: they part it into layers, each of which is closed
// by joints of its own, so that small joints need not cross the whole tile. So do those of a persistent set at which all
// other persistent ones end.
std::vector<Region> RegionSplitter::bedded(Region slab) {
  const Vec3 up = slab.walls[1].plane.normal;
  const double floor = slab.walls[0].plane.offset;
  const double pitch = -slab.walls[1].plane.offset - floor;
  std::vector<std::pair<double, int>> beds;
  for (int i = 0; i < static_cast<int>(discs_.size()); ++i) {
    const Disc& disc = discs_[static_cast<std::size_t>(i)];
    const double bend = angle(glm::dot(disc.normal, up));
    if (disc.radius < kBeddingRadius * options_.side || bend > kBeddingBend || disc.age != 0 || is_spent(slab, i))
      continue;
    const double along = glm::dot(up, disc.centre) - floor;
    beds.emplace_back(floor + along - pitch * std::floor(along / pitch), i);
  }
  const int wall = slab.walls[0].joint;
  const int set = wall >= 0 ? discs_[static_cast<std::size_t>(wall)].set : -1;
  if (set >= 0 && is_persistent(options_.sets[static_cast<std::size_t>(set)]) &&
      others_end_at(static_cast<std::size_t>(set))) {
    slab.layered_sets.push_back(set);
    Rng rng(seed_, "layers");
    for (const double t : closed_positions(options_.sets[static_cast<std::size_t>(set)], pitch,
                                           {.least = 2.0 * options_.min_inradius}, true, rng)) {
      if (t == 0.0) continue;
      Disc bed = discs_[static_cast<std::size_t>(wall)];
      bed.centre = (floor + t) * up;
      bed.normal = up;
      discs_.push_back(bed);
      beds.emplace_back(floor + t, static_cast<int>(discs_.size()) - 1);
    }
  }
  return layers(std::move(slab), std::move(beds));
}

// Parts a slab at the given heights, as far as layers do not become too thin.
std::vector<Region> RegionSplitter::layers(Region slab, std::vector<std::pair<double, int>> beds) {
  const Vec3 up = slab.walls[1].plane.normal;
  const double floor = slab.walls[0].plane.offset;
  const double ceiling = -slab.walls[1].plane.offset;
  std::stable_sort(beds.begin(), beds.end());
  const double thinnest = 2.0 * options_.min_inradius;
  std::vector<std::pair<double, int>> kept;
  for (const auto& [height, disc] : beds) {
    slab.spent.push_back(disc);
    const double below = kept.empty() ? floor : kept.back().first;
    if (height - below < thinnest || ceiling - height < thinnest) continue;
    kept.emplace_back(height, disc);
    largest_bend_ = std::max(largest_bend_, angle(glm::dot(discs_[static_cast<std::size_t>(disc)].normal, up)));
  }
  if (kept.empty()) return {std::move(slab)};

  std::vector<Region> result(kept.size() + 1);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].periods = slab.periods;
    result[i].spent = slab.spent;
    result[i].layered_sets = slab.layered_sets;
    result[i].walls = slab.walls;
    if (i > 0) result[i].walls[0] = {{-up, kept[i - 1].first}, kept[i - 1].second};
    if (i < kept.size()) result[i].walls[1] = {{up, -kept[i].first}, kept[i].second};
  }
  for (std::size_t k = 0; k < slab.samples.size(); ++k) {
    const double height = glm::dot(up, slab.positions[k]);
    const auto above = std::upper_bound(kept.begin(), kept.end(), height,
                                        [](double h, const std::pair<double, int>& bed) { return h < bed.first; });
    Region& layer = result[static_cast<std::size_t>(above - kept.begin())];
    layer.samples.push_back(slab.samples[k]);
    layer.positions.push_back(slab.positions[k]);
  }
  return result;
}

}  // namespace outcrop

#include "region.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

namespace outcrop {
namespace {

constexpr int kLongestNormal = 9;  // |m|² of the whole vectors that a normal may be turned to.
constexpr double kLengthPenalty =
    8.0 * kPi / 180.0;  // Radians of bend that one more tile of |m| is worth: long m, many planes.
constexpr double kLargestBend = 30.0 * kPi / 180.0;  // Radians; beyond it a joint is added instead.
constexpr double kBeddingBend = 20.0 * kPi / 180.0;  // Radians between a slab's normal and a joint that runs along it.
constexpr double kBeddingRadius = 0.75;              // Of the side: wider joints cross the whole tile.
constexpr double kSameSize = 0.5;   // Discs of at least this share of the largest radius may close a region.
constexpr double kSteepest = 0.82;  // |cos| between the walls of a rod: about 35°.
constexpr double kAcross = 0.5;     // |cos| between a rod's direction and the normal that cuts it.

int dot(const IVec3& a, const IVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

IVec3 cross(const IVec3& a, const IVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

int gcd(int a, int b) { return b == 0 ? std::abs(a) : gcd(b, a % b); }

Vec3 unit(const IVec3& v) { return glm::normalize(Vec3(v)); }

// All whole vectors with |components| ≤ 2, shortest first: enough for |m|² ≤ 9.
const std::vector<IVec3>& small_vectors() {
  static const std::vector<IVec3> vectors = [] {
    std::vector<IVec3> result;
    for (int z = -2; z <= 2; ++z)
      for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x)
          if (x || y || z) result.push_back({x, y, z});
    std::stable_sort(result.begin(), result.end(),
                     [](const IVec3& a, const IVec3& b) { return dot(a, a) < dot(b, b); });
    return result;
  }();
  return vectors;
}

// Whole vectors that have no shorter one along them, one of ± each.
std::vector<IVec3> primitive_vectors() {
  std::vector<IVec3> result;
  for (const IVec3& v : small_vectors()) {
    const bool is_positive = v.z > 0 || (v.z == 0 && (v.y > 0 || (v.y == 0 && v.x > 0)));
    if (is_positive && dot(v, v) <= kLongestNormal && gcd(gcd(v.x, v.y), v.z) == 1) result.push_back(v);
  }
  return result;
}

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

// The least cost among the largest candidates, so that large joints come first without a detour for the very largest.
template <class Candidate>
const Candidate* best_of(const std::vector<Candidate>& candidates) {
  double largest = 0.0;
  for (const Candidate& c : candidates) largest = std::max(largest, c.radius);
  const Candidate* best = nullptr;
  for (const Candidate& c : candidates)
    if (c.radius >= kSameSize * largest && (!best || c.cost < best->cost)) best = &c;
  return best;
}

}  // namespace

RegionSplitter::RegionSplitter(const std::vector<Disc>& discs, const ClusterOptions& options, Seed seed)
    : discs_(discs), options_(options), seed_(seed) {}

std::vector<Region> RegionSplitter::run(const std::vector<Vec3>& samples) {
  std::vector<Region> rods;
  if (options_.column_width > 0.0) {
    rods = column_regions(samples, options_.side, options_.column_width, seed_);
  } else {
    Region torus;
    torus.periods = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    torus.positions = samples;
    torus.samples.resize(samples.size());
    for (std::uint32_t i = 0; i < samples.size(); ++i) torus.samples[i] = i;
    for (Region& slab : bedded(close(std::move(torus), torus_closing()))) {
      const Closing closing = slab_closing(slab);
      rods.push_back(close(std::move(slab), closing));
    }
  }
  std::vector<Region> cells;
  for (Region& rod : rods) {
    const Closing closing = rod_closing(rod);
    cells.push_back(close(std::move(rod), closing));
  }
  return cells;
}

bool RegionSplitter::is_spent(const Region& region, int disc) const {
  return std::find(region.spent.begin(), region.spent.end(), disc) != region.spent.end();
}

// A plane closes on the torus when its normal is a whole vector m; it passes the tile |m| times, so that short m are
// better.
RegionSplitter::Closing RegionSplitter::torus_closing() {
  struct Candidate {
    double cost, radius;
    int disc;
    IVec3 m;
    double bend;
  };
  std::vector<Candidate> candidates;
  for (int i = 0; i < static_cast<int>(discs_.size()); ++i)
    for (const IVec3& m : primitive_vectors()) {
      const Disc& disc = discs_[static_cast<std::size_t>(i)];
      const double bend = angle(glm::dot(disc.normal, unit(m)));
      if (bend <= kLargestBend)
        candidates.push_back({bend + kLengthPenalty * (std::sqrt(dot(m, m)) - 1.0), disc.radius, i, m, bend});
    }
  Closing closing;
  IVec3 m{0, 0, 1};
  if (const Candidate* best = best_of(candidates)) {
    m = best->m;
    closing.centre = discs_[static_cast<std::size_t>(best->disc)].centre;
    closing.joint = best->disc;
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
    int disc;
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
      if (dot(w, w) > kLongestNormal) continue;
      for (int c = -2; c <= 2; ++c)
        for (int d = -2; d <= 2; ++d)
          if (a * d - b * c == 1) {
            ways.push_back({w, c * slab.periods[0] + d * slab.periods[1]});
            c = d = 3;  // any complement will do: they differ by w
          }
    }

  std::vector<Candidate> candidates;
  for (int i = 0; i < static_cast<int>(discs_.size()); ++i) {
    const Disc& disc = discs_[static_cast<std::size_t>(i)];
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
      candidates.push_back({bend + kLengthPenalty * (glm::length(Vec3(way.w)) - 1.0), disc.radius, i, flat / length,
                            centre, way.w, way.step, bend});
    }
  }
  Closing closing;
  if (const Candidate* best = best_of(candidates)) {
    closing = {best->normal, best->centre, best->step, {best->w}, best->disc, best->bend};
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
    int disc;
    Vec3 centre;
  };
  const IVec3 w = rod.periods[0];
  const Vec3 along = unit(w);
  std::vector<Plane> planes;
  for (const Region::Wall& wall : rod.walls) planes.push_back(wall.plane);
  const Vec3 start = -planes[0].offset * planes[0].normal;
  const Vec3 middle = inscribed_ball(planes, start, options_.side).centre;

  std::vector<Candidate> candidates;
  for (int i = 0; i < static_cast<int>(discs_.size()); ++i) {
    const Disc& disc = discs_[static_cast<std::size_t>(i)];
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
    if (centre) candidates.push_back({-across, disc.radius, i, *centre});
  }
  Closing closing;
  if (const Candidate* best = best_of(candidates)) {
    closing.normal = discs_[static_cast<std::size_t>(best->disc)].normal;
    closing.centre = best->centre;
    closing.joint = best->disc;
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
  region.periods = closing.periods;
  if (closing.joint >= 0) region.spent.push_back(closing.joint);
  largest_bend_ = std::max(largest_bend_, closing.bend);
  return region;
}

// Joints about as wide as the tile that run along a slab are bedding: they part it into layers, each of which is closed
// by joints of its own, so that small joints need not cross the whole tile.
std::vector<Region> RegionSplitter::bedded(Region slab) {
  const Vec3 up = slab.walls[1].plane.normal;
  const double floor = slab.walls[0].plane.offset;
  const double ceiling = -slab.walls[1].plane.offset;
  std::vector<std::pair<double, int>> beds;
  for (int i = 0; i < static_cast<int>(discs_.size()); ++i) {
    const Disc& disc = discs_[static_cast<std::size_t>(i)];
    const double bend = angle(glm::dot(disc.normal, up));
    if (disc.radius < kBeddingRadius * options_.side || bend > kBeddingBend || is_spent(slab, i)) continue;
    const double pitch = ceiling - floor;
    const double along = glm::dot(up, disc.centre) - floor;
    const double height = floor + along - pitch * std::floor(along / pitch);
    beds.emplace_back(height, i);
  }
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

  std::vector<Region> layers(kept.size() + 1);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    layers[i].periods = slab.periods;
    layers[i].spent = slab.spent;
    layers[i].walls = slab.walls;
    if (i > 0) layers[i].walls[0] = {{-up, kept[i - 1].first}, kept[i - 1].second};
    if (i < kept.size()) layers[i].walls[1] = {{up, -kept[i].first}, kept[i].second};
  }
  for (std::size_t k = 0; k < slab.samples.size(); ++k) {
    const double height = glm::dot(up, slab.positions[k]);
    const auto above = std::upper_bound(kept.begin(), kept.end(), height,
                                        [](double h, const std::pair<double, int>& bed) { return h < bed.first; });
    Region& layer = layers[static_cast<std::size_t>(above - kept.begin())];
    layer.samples.push_back(slab.samples[k]);
    layer.positions.push_back(slab.positions[k]);
  }
  return layers;
}

}  // namespace outcrop

// Embree's floats only sort leaves; all that decides a hit is done in doubles in world coordinates.
#include "outcrop/render/tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "leaves.h"
#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"

namespace outcrop {
namespace {

using render::Leaf;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kStepCap = 256;           // Steps in one leaf before steps grow to the ray's width.
constexpr double kSmallestStep = 0.5;  // Of the ray's width.
constexpr double kRootWidth = 0.06;     // A hit is found to this share of the ray's width …
constexpr double kRootDistance = 1e-4;  // … and to this share of its distance.
constexpr int kRootBatches = 12;
constexpr int kBatch = 6;               // Values at a time.
constexpr int kDepth = 24;              // Of stretches within stretches; each is an eighth of its parent at most.
constexpr double kTiniest = 1e-9;       // Relative: where doubles end.
constexpr double kLabelDepth = 0.5;     // Ray widths inside the rock at which its label is asked for.
constexpr double kFloatSlack = 4e-7;    // Relative: rounding of positions to floats, with room to spare.

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Where the ray is inside a box, and the axis of the side by which it enters.
struct Clip {
  double begin = 0.0, end = -1.0;
  int axis = -1;  // −1: it starts inside.

  [[nodiscard]] bool empty() const { return !(begin <= end); }
};

Clip clip(const Box& box, const Ray& ray) noexcept {
  Clip result{0.0, ray.t_max, -1};
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0.0) {
      if (o < box.lo[axis] || o > box.hi[axis]) return {};
      continue;
    }
    const double near = ((d > 0.0 ? box.lo : box.hi)[axis] - o) / d;
    const double far = ((d > 0.0 ? box.hi : box.lo)[axis] - o) / d;
    if (near > result.begin) result.begin = near, result.axis = axis;
    result.end = std::min(result.end, far);
  }
  return result;
}

/// Where a ray meets rock in a leaf: the first rock is at t or within the tolerance behind it.
struct Crossing {
  double t = kInfinity;
  bool at_entry = false;  // Already in rock where the ray enters.
};

/// Searches one leaf along one ray.
///
/// Sphere tracing, several balls at a time: a value v at t proves the ray free on both sides of t for v / L, and for what
/// the modulus says (as the overlapping balls of Keinert et al. 2014, section 3.1), and a batch of values costs little more than one. Stretches
/// that no ball covers are sampled again, until they are shorter than the smallest step.
class March {
 public:
  March(const Leaf& leaf, const Ray& ray, bool any) : leaf_(leaf), ray_(ray), any_(any) {}

  Crossing first(double begin, double end) noexcept {
    Batch batch;
    batch.count = points_for(begin, end);
    for (int i = 0; i < batch.count; ++i) batch.t[i] = begin + (end - begin) * i / (batch.count - 1);
    evaluate(batch);
    if (batch.v[0] <= 0.0) return {begin, true};
    air_ = free_ = begin;
    return {scan(batch, end, 0), false};
  }

  [[nodiscard]] int steps() const noexcept { return steps_; }
  [[nodiscard]] bool capped() const noexcept { return steps_ > kStepCap; }

 private:
  struct Batch {
    int count = 0;
    double t[kBatch];
    double v[kBatch];
  };

  /// How far around a place with the value v > 0 there is air.
  [[nodiscard]] double reach(double v) const noexcept {
    return std::max(v / leaf_.lipschitz, leaf_.modulus.reach(v));
  }

  [[nodiscard]] double smallest_step(double t) const noexcept {
    const double width = ray_.width(t);
    return std::max(steps_ > kStepCap ? width : kSmallestStep * width, kTiniest * std::max(t, 1.0));
  }

  /// As many as make sense between a and b, at least 2.
  [[nodiscard]] int points_for(double a, double b) const noexcept {
    return 2 + static_cast<int>(std::min((b - a) / smallest_step(a), kBatch - 2.0));
  }

  void evaluate(Batch& batch) noexcept {
    double x[kBatch], y[kBatch], z[kBatch];
    const auto n = static_cast<std::size_t>(batch.count);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 p = ray_.at(batch.t[i]);
      x[i] = p.x, y[i] = p.y, z[i] = p.z;
    }
    // In rock nobody asks how deep.
    constexpr double kFloors[kBatch] = {};
    std::fill_n(batch.v, n, kInfinity);
    leaf_.field->between({{x, n}, {y, n}, {z, n}}, {kFloors, n}, {batch.v, n}, {});
    steps_ += batch.count;
  }

  /// Goes through a batch from the front; the first place with f ≤ 0 before `end`, or infinity once all of it is free.
  double scan(const Batch& batch, double end, int depth) noexcept {
    if (any_ && std::any_of(batch.v, batch.v + batch.count, [](double v) { return v <= 0.0; })) return batch.t[0];
    for (int i = 0; i < batch.count; ++i) {
      const double t = batch.t[i], v = batch.v[i];
      if (t < air_) continue;
      const double near = v > 0.0 ? t - reach(v) : t;
      if (const double found = close(near, depth); found < kInfinity) return found;
      if (v <= 0.0) return any_ ? t : root(std::max(air_, std::min(free_, t)), t);
      air_ = t;
      free_ = std::max(free_, t + reach(v));
    }
    return close(end, depth);
  }

  /// Looks into the stretch between what is known to be free and `until`, if it is long enough to matter.
  double close(double until, int depth) noexcept {
    if (until - free_ <= smallest_step(free_) || depth == kDepth) return kInfinity;
    Batch batch;
    const double begin = free_;
    batch.count = points_for(begin, until) - 1;
    for (int i = 0; i < batch.count; ++i) batch.t[i] = begin + (until - begin) * (i + 1) / (batch.count + 1);
    evaluate(batch);
    return scan(batch, until, depth + 1);
  }

  /// The air end of a bracket of the surface: a holds air, b rock.
  double root(double a, double b) noexcept {
    const double tolerance = std::max(std::min(kRootWidth * ray_.width(b), kRootDistance * b), kTiniest * b);
    for (int i = 0; i < kRootBatches && b - a > tolerance; ++i) {
      Batch batch;
      batch.count = std::min(kBatch, static_cast<int>((b - a) / tolerance) + 1);
      for (int k = 0; k < batch.count; ++k) batch.t[k] = a + (b - a) * (k + 1) / (batch.count + 1);
      evaluate(batch);
      const double left = a;
      for (int k = 0; k < batch.count; ++k) {
        if (batch.v[k] <= 0.0) {
          b = batch.t[k];
          break;
        }
        a = batch.t[k];
      }
      if (a == left && b - a <= kTiniest * b) break;
    }
    return a;
  }

  const Leaf& leaf_;
  const Ray& ray_;
  bool any_;           // Any rock will do: nothing is refined.
  double air_ = 0.0;   // The last place known by its value to be air.
  double free_ = 0.0;  // All before it is free.
  int steps_ = 0;
};

[[noreturn]] void fail(RTCDevice device, const char* what) {
  throw SystemError(std::string("Embree: cannot ") + what + ", error " +
                    std::to_string(static_cast<int>(rtcGetDeviceError(device))));
}

}  // namespace

struct Tracer::Impl {
  TracerOptions options;
  Vec3 origin{0.0};  // World position of Embree's origin.
  float slack = 0.0f;
  std::vector<Leaf> leaves;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  void build_scene();
  [[nodiscard]] bool embree_ray(const Ray& ray, const Clip& inside, RTCRay& out) const noexcept;
  static void bounds_of(const RTCBoundsFunctionArguments* args);
  static void intersect(const RTCIntersectFunctionNArguments* args);
  static void occluded(const RTCOccludedFunctionNArguments* args);
};

namespace {

/// What the callbacks need beside Embree's own ray; Embree hands the first member's address through.
struct Query {
  RTCIntersectContext context;
  const Ray* ray = nullptr;
  double region_begin = 0.0;
  double best = kInfinity;
  unsigned leaf = RTC_INVALID_GEOMETRY_ID;
  bool at_entry = false;
  bool any = false;  // Whether, not where.
  RayCounters* counters = nullptr;
};

Crossing search(const Leaf& leaf, Query& query) noexcept {
  const Ray& ray = *query.ray;
  Clip inside = clip(leaf.box, ray);
  inside.begin = std::max(inside.begin, query.region_begin);
  if (inside.empty() || inside.begin >= query.best) return {};
  March march(leaf, ray, query.any);
  const Crossing crossing = march.first(inside.begin, inside.end);
  query.counters->steps += static_cast<std::size_t>(march.steps());
  query.counters->capped += march.capped();
  return crossing;
}

float up(double v) noexcept {
  return std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity());
}

}  // namespace

void Tracer::Impl::bounds_of(const RTCBoundsFunctionArguments* args) {
  const auto& self = *static_cast<const Impl*>(args->geometryUserPtr);
  const Box box = self.leaves[args->primID].box.moved(-self.origin);
  RTCBounds& out = *args->bounds_o;
  out.lower_x = static_cast<float>(box.lo.x) - self.slack;
  out.lower_y = static_cast<float>(box.lo.y) - self.slack;
  out.lower_z = static_cast<float>(box.lo.z) - self.slack;
  out.upper_x = static_cast<float>(box.hi.x) + self.slack;
  out.upper_y = static_cast<float>(box.hi.y) + self.slack;
  out.upper_z = static_cast<float>(box.hi.z) + self.slack;
}

void Tracer::Impl::intersect(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& self = *static_cast<const Impl*>(args->geometryUserPtr);
  auto& query = *reinterpret_cast<Query*>(args->context);
  const Crossing crossing = search(self.leaves[args->primID], query);
  const bool tie = crossing.t == query.best && args->primID < query.leaf;
  if (!(crossing.t < query.best || tie) || crossing.t == kInfinity) return;
  query.best = crossing.t;
  query.leaf = args->primID;
  query.at_entry = crossing.at_entry;
  auto& hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  hit.ray.tfar = std::min(hit.ray.tfar, up(crossing.t - query.region_begin) + self.slack);
  hit.hit.geomID = args->geomID;
  hit.hit.primID = args->primID;
}

void Tracer::Impl::occluded(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& self = *static_cast<const Impl*>(args->geometryUserPtr);
  auto& query = *reinterpret_cast<Query*>(args->context);
  if (search(self.leaves[args->primID], query).t == kInfinity) return;
  reinterpret_cast<RTCRay*>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
}

void Tracer::Impl::build_scene() {
  device = rtcNewDevice(nullptr);
  if (!device) fail(nullptr, "start");
  scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  if (!scene || !geometry) fail(device, "make a scene");
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(leaves.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(
      geometry, [](const RTCBoundsFunctionArguments* args) { bounds_of(args); }, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occluded);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  // On one thread: the hierarchy, and with it the number of steps, is then always the same.
  const ThreadLimit alone(1);
  rtcCommitScene(scene);
  if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
    throw SystemError("Embree: cannot build the hierarchy of " + std::to_string(leaves.size()) + " boxes, error " +
                      std::to_string(static_cast<int>(error)));
}

/// The part inside the region, so that far cameras cost no digits.
bool Tracer::Impl::embree_ray(const Ray& ray, const Clip& inside, RTCRay& out) const noexcept {
  if (inside.empty() || leaves.empty()) return false;
  const Vec3f start(ray.at(inside.begin) - origin), direction(ray.direction);
  out = {};
  out.org_x = start.x, out.org_y = start.y, out.org_z = start.z;
  out.dir_x = direction.x, out.dir_y = direction.y, out.dir_z = direction.z;
  out.tnear = 0.0f;
  out.tfar = up(inside.end - inside.begin) + slack;
  out.mask = ~0u;
  return true;
}

Tracer::Tracer(const Field& field, const TracerOptions& options, const Task& task) : impl_(std::make_unique<Impl>()) {
  const Box& region = options.region;
  require(finite(region.lo) && finite(region.hi) && region.lo.x < region.hi.x && region.lo.y < region.hi.y &&
              region.lo.z < region.hi.z,
          "region", "a finite box with a volume", "another");
  require(options.detail > 0.0 && std::isfinite(options.detail), "detail", "> 0 m", options.detail);
  require(options.leaf_details > 0.0, "leaf_details", "> 0", options.leaf_details);
  require(options.max_leaves > 0, "max_leaves", "> 0", static_cast<double>(options.max_leaves));
  impl_->options = options;
  impl_->origin = region.centre();
  impl_->slack = static_cast<float>(kFloatSlack * 2.0 * region.half_diagonal());
  impl_->leaves = render::build_leaves(field, options, task);
  task.check();
  if (!impl_->leaves.empty()) impl_->build_scene();
}

Tracer::~Tracer() = default;

std::size_t Tracer::leaf_count() const noexcept { return impl_->leaves.size(); }

std::optional<RayHit> Tracer::closest(const Ray& ray, RayCounters& counters) const noexcept {
  ++counters.rays;
  const Clip inside = clip(impl_->options.region, ray);
  RTCRayHit rayhit;
  if (!impl_->embree_ray(ray, inside, rayhit.ray)) return std::nullopt;
  rayhit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rayhit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  Query query{.context = {}, .ray = &ray, .region_begin = inside.begin, .counters = &counters};
  rtcInitIntersectContext(&query.context);
  rtcIntersect1(impl_->scene, &query.context, &rayhit);
  if (query.best > inside.end) return std::nullopt;

  const Field& field = *impl_->leaves[query.leaf].field;
  RayHit hit;
  hit.t = query.best;
  hit.position = ray.at(query.best);
  hit.cut = query.at_entry && inside.axis >= 0 && query.best <= inside.begin;
  if (hit.cut) {
    hit.normal = Vec3(0.0);
    hit.normal[inside.axis] = ray.direction[inside.axis] > 0.0 ? -1.0 : 1.0;
  } else {
    const Vec3 gradient = field.gradient(hit.position);
    const double length = glm::length(gradient);
    hit.normal = length > 1e-9 && std::isfinite(length) ? gradient / length : -ray.direction;
  }
  const Box& box = impl_->leaves[query.leaf].box;  // Where the narrowed field holds.
  const Vec3 inner = glm::clamp(hit.position - kLabelDepth * ray.width(hit.t) * hit.normal, box.lo, box.hi);
  field.labels({{&inner.x, 1}, {&inner.y, 1}, {&inner.z, 1}}, {&hit.label, 1});
  return hit;
}

bool Tracer::blocked(const Ray& ray, RayCounters& counters) const noexcept {
  ++counters.rays;
  const Clip inside = clip(impl_->options.region, ray);
  RTCRay embree;
  if (!impl_->embree_ray(ray, inside, embree)) return false;
  Query query{.context = {}, .ray = &ray, .region_begin = inside.begin, .any = true, .counters = &counters};
  rtcInitIntersectContext(&query.context);
  rtcOccluded1(impl_->scene, &query.context, &embree);
  return embree.tfar < 0.0f;
}

}  // namespace outcrop

#include "outcrop/render/camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "outcrop/core/error.h"
#include "outcrop/render/tracer.h"

namespace outcrop {
namespace {

constexpr int kFocusGrid = 6;         // Points an axis over the focus; those near the surface count.
constexpr double kProbeWidth = 0.1;   // Width of the rays that look for rock, as a share of the lattice's cell.
constexpr std::size_t kProbeLeaves = 30'000;
constexpr double kTurnPenalty = 0.2;  // Share of the view that one radian of turning away must gain.
constexpr double kNearPenalty = 0.2;  // The same for going all the way in.
constexpr double kClearance = 0.01;   // Air around the camera, as a share of the focus's diagonal.

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void require_frame(const Box& focus, const Vec3& direction, double field_of_view, double aspect) {
  require(!focus.empty() && finite(focus.lo) && finite(focus.hi), "focus", "a box that is finite and not empty",
          "another");
  require(finite(direction) && glm::length(direction) > 0.0, "view_direction", "a finite vector that is not zero",
          "another");
  require(field_of_view > 0.0 && field_of_view < kPi, "field_of_view", "in (0, pi)", field_of_view);
  require(aspect > 0.0 && std::isfinite(aspect), "aspect", "> 0", aspect);
}

Vec3 direction_of(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

/// Estimates of the signed distance to the surface.
std::vector<double> distances_at(const Field& field, const std::vector<Vec3>& points) {
  const std::size_t n = points.size();
  std::vector<double> x(n), y(n), z(n), distances(n);
  std::vector<Vec3> gradients(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = points[i].x, y[i] = points[i].y, z[i] = points[i].z;
  field.values({x, y, z}, distances, gradients);
  for (std::size_t i = 0; i < n; ++i) distances[i] /= std::max(glm::length(gradients[i]), 1e-6);
  return distances;
}

/// Lattice points of the box within one lattice cell of the surface; all of them where there is no surface.
std::vector<Vec3> surface_points(const Field& field, const Box& box, double reach) {
  std::vector<Vec3> all, near;
  for (int k = 0; k < kFocusGrid; ++k)
    for (int j = 0; j < kFocusGrid; ++j)
      for (int i = 0; i < kFocusGrid; ++i)
        all.push_back(box.lo + (Vec3(i, j, k) + 0.5) / double(kFocusGrid) * box.size());
  const std::vector<double> distances = distances_at(field, all);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (std::abs(distances[i]) < reach) near.push_back(all[i]);
  return near.empty() ? all : near;
}

/// Share of `points` in the picture with no rock before them, but for the last `reach` metres.
double visible_share(const Tracer& tracer, const Camera& camera, double aspect, const std::vector<Vec3>& points,
                     double reach) {
  const CameraAxes axes = camera_axes(camera);
  const double tan_v = std::tan(0.5 * camera.field_of_view), tan_h = tan_v * aspect;
  std::size_t seen = 0;
  RayCounters unused;
  for (const Vec3& p : points) {
    const Vec3 to_point = p - camera.position;
    const double depth = glm::dot(to_point, axes.forward), length = glm::length(to_point);
    if (depth <= 0.0 || std::abs(glm::dot(to_point, axes.right)) > depth * tan_h ||
        std::abs(glm::dot(to_point, axes.up)) > depth * tan_v)
      continue;
    seen += !tracer.blocked({.origin = camera.position,
                             .direction = to_point / length,
                             .t_max = std::max(0.0, length - reach),
                             .base_width = kProbeWidth * reach,
                             .spread = 0.0},
                            unused);
  }
  return static_cast<double>(seen) / static_cast<double>(points.size());
}

struct Candidate {
  double azimuth, elevation, distance, penalty;
};

std::vector<Candidate> candidates_around(const Vec3& from) {
  const double azimuth = std::atan2(from.y, from.x);
  const double elevation = std::asin(std::clamp(glm::normalize(from).z, -1.0, 1.0));
  std::vector<Candidate> result;
  for (const double turn_deg : {0.0, -15.0, 15.0, -30.0, 30.0, -50.0, 50.0, -75.0, 75.0})
    for (const double rise_deg : {0.0, 8.0, 18.0, 30.0, 45.0})
      for (const double distance : {1.0, 0.7, 0.5}) {
        const double turn = radians(turn_deg), rise = radians(rise_deg);
        result.push_back({azimuth + turn, std::min(elevation + rise, 0.45 * kPi), distance,
                          kTurnPenalty * (std::abs(turn) + std::abs(rise)) + kNearPenalty * (1.0 - distance)});
      }
  std::stable_sort(result.begin(), result.end(),
                   [](const Candidate& a, const Candidate& b) { return a.penalty < b.penalty; });
  return result;
}

}  // namespace

CameraAxes camera_axes(const Camera& camera) {
  require(finite(camera.position), "camera.position", "finite coordinates", "another");
  const Vec3 towards = camera.target - camera.position;
  require(finite(towards) && glm::length(towards) > 0.0, "camera.target", "a place other than camera.position",
          "the same");
  require(camera.field_of_view > 0.0 && camera.field_of_view < kPi, "camera.field_of_view", "in (0, pi)",
          camera.field_of_view);
  const Vec3 forward = glm::normalize(towards);
  const Vec3 towards_up = std::abs(forward.z) > 1.0 - 1e-9 ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  const Vec3 right = glm::normalize(glm::cross(forward, towards_up));
  return {right, glm::cross(right, forward), forward};
}

Camera frame_box(const Box& focus, const Vec3& view_direction, double field_of_view, double aspect) {
  require_frame(focus, view_direction, field_of_view, aspect);
  const Vec3 centre = focus.centre();
  // Axes are taken at the origin: the direction must not lose digits to far coordinates.
  const CameraAxes axes = camera_axes({Vec3(0.0), view_direction, field_of_view});
  const double tan_v = std::tan(0.5 * field_of_view), tan_h = tan_v * aspect;
  double distance = 1e-3;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Vec3 offset = 0.5 * sign * focus.size();
    const double depth = glm::dot(offset, axes.forward);
    distance = std::max({distance, std::abs(glm::dot(offset, axes.right)) / tan_h - depth,
                         std::abs(glm::dot(offset, axes.up)) / tan_v - depth});
  }
  return {centre - axes.forward * distance, centre, field_of_view};
}

Camera framed(const Field& field, const Box& focus, const Vec3& from_direction, double field_of_view, double aspect,
              const std::optional<Box>& drawn) {
  require_frame(focus, from_direction, field_of_view, aspect);
  const double diagonal = 2.0 * focus.half_diagonal();
  const double reach = std::max(diagonal / kFocusGrid, 1e-3), clearance = kClearance * diagonal;
  const std::vector<Vec3> points = surface_points(field, focus, reach);

  const std::vector<Candidate> candidates = candidates_around(from_direction);
  std::vector<Camera> cameras;
  std::vector<Vec3> places;
  Box region = focus;
  for (const Candidate& candidate : candidates) {
    Camera camera = frame_box(focus, -direction_of(candidate.azimuth, candidate.elevation), field_of_view, aspect);
    camera.position = camera.target + (camera.position - camera.target) * candidate.distance;
    region.include(camera.position);
    places.push_back(camera.position);
    cameras.push_back(camera);
  }
  const auto in_air = [&](const Vec3& place, double distance) {
    return distance >= clearance || (drawn && !drawn->grown(clearance).contains(place));
  };
  const std::vector<double> distances = distances_at(field, places);
  region = region.grown(reach);
  const Box cut = drawn ? intersection(region, *drawn) : region;
  const bool anything = cut.lo.x < cut.hi.x && cut.lo.y < cut.hi.y && cut.lo.z < cut.hi.z;
  const Tracer tracer(field, {.region = anything ? cut : focus.grown(reach),
                              .detail = reach,
                              .leaf_details = 0.5,
                              .eye = focus.centre(),
                              .spread = 0.0,
                              .view_angle = kPi,
                              .max_leaves = kProbeLeaves});

  Camera best;
  double best_score = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (best_score >= 1.0 - candidates[i].penalty) break;  // Sorted by penalty: nothing better can follow.
    if (!in_air(places[i], distances[i])) continue;
    const double score = visible_share(tracer, cameras[i], aspect, points, reach) - candidates[i].penalty;
    if (score > best_score) best = cameras[i], best_score = score;
  }
  if (best_score > 0.0) return best;

  // Buried from everywhere: straight above, as high as it takes.
  Camera above = frame_box(focus, {0, 0, -1}, field_of_view, aspect);
  for (int i = 0; i < 64 && !in_air(above.position, distances_at(field, {above.position})[0]); ++i)
    above.position.z += diagonal * (1 + i);
  return above;
}

}  // namespace outcrop

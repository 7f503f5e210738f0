/// How far a mesh lies off the field that it was made from.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/field.h"
#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop::test {

struct Distances {
  double mean = 0.0, largest = 0.0;
};

/// The distance from p to the surface along the gradient, by bisection; `reach` when there is none that near.
inline double distance_to_surface(const Field& field, const Vec3& p, double reach) {
  const double f = field.value(p);
  const Vec3 gradient = field.gradient(p);
  if (!(glm::length(gradient) > 0.0)) return reach;
  const Vec3 way = glm::normalize(gradient) * (f < 0.0 ? 1.0 : -1.0);
  const auto crossed = [&](double s) { return (field.value(p + s * way) < 0.0) != (f < 0.0); };
  double hi = reach / 1024;
  while (hi < reach && !crossed(hi)) hi *= 2.0;
  if (hi >= reach) return reach;
  double lo = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lo + hi);
    (crossed(middle) ? hi : lo) = middle;
  }
  return hi;
}

/// Over `count` points, spread evenly over the mesh's area.
inline Distances distances_to_surface(const TriangleMesh& mesh, const Field& field, std::size_t count, double reach) {
  std::vector<double> area;
  double sum = 0.0;
  const auto corner = [&](std::uint32_t v) { return mesh.origin + Vec3(mesh.positions[v]); };
  for (const auto& t : mesh.triangles) {
    sum += glm::length(glm::cross(corner(t[1]) - corner(t[0]), corner(t[2]) - corner(t[0])));
    area.push_back(sum);
  }
  Distances result;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(1, "points on triangles", i);
    const double place = (static_cast<double>(i) + rng.uniform()) / static_cast<double>(count) * sum;
    const auto& t = mesh.triangles[std::min<std::size_t>(
        std::lower_bound(area.begin(), area.end(), place) - area.begin(), area.size() - 1)];
    double u = rng.uniform(), v = rng.uniform();
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const Vec3 p = (1.0 - u - v) * corner(t[0]) + u * corner(t[1]) + v * corner(t[2]);
    const double distance = distance_to_surface(field, p, reach);
    result.mean += distance / static_cast<double>(count);
    result.largest = std::max(result.largest, distance);
  }
  return result;
}

/// In degrees.
inline double smallest_angle(const TriangleMesh& mesh) {
  double smallest = kPi;
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const Vec3 a(mesh.positions[t[i]]);
      const Vec3 u = glm::normalize(Vec3(mesh.positions[t[(i + 1) % 3]]) - a);
      const Vec3 v = glm::normalize(Vec3(mesh.positions[t[(i + 2) % 3]]) - a);
      smallest = std::min(smallest, std::acos(std::clamp(glm::dot(u, v), -1.0, 1.0)));
    }
  return degrees(smallest);
}

}  // namespace outcrop::test

#include <algorithm>
#include <cmath>

#include "outcrop/fracture/tile.h"

namespace outcrop {
namespace {

// Eigenvalues of a symmetric matrix, by its characteristic cubic's trigonometric roots (Smith 1961).
std::array<double, 3> eigenvalues(const Mat3& m) {
  const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3.0;
  const Mat3 rest = m - mean * Mat3(1.0);
  double squares = 0.0;
  for (int c = 0; c < 3; ++c) squares += glm::dot(rest[c], rest[c]);
  const double p = std::sqrt(squares / 6.0);
  if (p <= 1e-14 * std::abs(mean)) return {mean, mean, mean};
  const double half_det = 0.5 * glm::dot(rest[0], glm::cross(rest[1], rest[2])) / (p * p * p);
  const double turn = std::acos(std::clamp(half_det, -1.0, 1.0)) / 3.0;
  const double most = mean + 2.0 * p * std::cos(turn);
  const double least = mean + 2.0 * p * std::cos(turn + 2.0 * kPi / 3.0);
  return {most, 3.0 * mean - most - least, least};
}

}  // namespace

std::array<double, 3> principal_sizes(const BlockMesh& mesh) noexcept {
  if (mesh.vertices.empty()) return {0.0, 0.0, 0.0};
  // Over a tetrahedron (o, a, b, c) of volume V: ∫x = V (a+b+c)/4 and ∫xxᵀ = V/20 (Σ vvᵀ + (Σv)(Σv)ᵀ), relative to o.
  const Vec3 o = mesh.vertices[0];
  double volume = 0.0;
  Vec3 first{0.0};
  Mat3 second{0.0};
  for (const auto& triangle : mesh.triangles) {
    const Vec3 v[3] = {mesh.vertices[triangle[0]] - o, mesh.vertices[triangle[1]] - o, mesh.vertices[triangle[2]] - o};
    const double part = glm::dot(v[0], glm::cross(v[1], v[2])) / 6.0;
    const Vec3 sum = v[0] + v[1] + v[2];
    volume += part;
    first += part / 4.0 * sum;
    for (int c = 0; c < 3; ++c)
      second[c] += part / 20.0 * (v[0][c] * v[0] + v[1][c] * v[1] + v[2][c] * v[2] + sum[c] * sum);
  }
  if (volume <= 0.0) return {0.0, 0.0, 0.0};
  const Vec3 mean = first / volume;
  Mat3 variance = second / volume;
  for (int c = 0; c < 3; ++c) variance[c] -= mean[c] * mean;
  std::array<double, 3> sizes = eigenvalues(variance);
  for (double& size : sizes) size = std::sqrt(12.0 * std::max(0.0, size));  // the variance of an edge e is e² / 12
  return sizes;
}

}  // namespace outcrop

#include "lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace outcrop {
namespace {

constexpr int kLongestNormal = 9;  // |m|² of the whole vectors that a normal may be turned to.

}  // namespace

int dot(const IVec3& a, const IVec3& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

IVec3 cross(const IVec3& a, const IVec3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vec3 unit(const IVec3& v) noexcept { return glm::normalize(Vec3(v)); }

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

const std::vector<IVec3>& primitive_vectors() {
  static const std::vector<IVec3> vectors = [] {
    std::vector<IVec3> result;
    for (const IVec3& v : small_vectors()) {
      const bool is_positive = v.z > 0 || (v.z == 0 && (v.y > 0 || (v.y == 0 && v.x > 0)));
      const int common = std::gcd(std::gcd(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
      if (is_positive && dot(v, v) <= kLongestNormal && common == 1) result.push_back(v);
    }
    return result;
  }();
  return vectors;
}

IVec3 nearest_whole_vector(const Vec3& normal) {
  const auto cost = [&](const IVec3& m) {
    const double turn = std::acos(std::min(1.0, std::abs(glm::dot(normal, unit(m)))));
    return turn + kLengthPenalty * (std::sqrt(dot(m, m)) - 1.0);
  };
  const std::vector<IVec3>& all = primitive_vectors();
  return *std::min_element(all.begin(), all.end(),
                           [&](const IVec3& a, const IVec3& b) { return cost(a) < cost(b); });
}

}  // namespace outcrop

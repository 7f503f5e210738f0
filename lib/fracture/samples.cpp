#include "outcrop/fracture/samples.h"

#include <algorithm>
#include <cmath>

#include "outcrop/core/error.h"
#include "wrapped_grid.h"

namespace outcrop {
namespace {

// Darts a live cube and round: few, since cubes that stay uncovered are halved and tried again.
constexpr double kDartsPerCube = 1.5;
constexpr int kMaxLevel = 20;  // Cubes of a millionth of the spacing: what is left uncovered then is rounding.

// Maximal Poisson-disc sampling by darts into an ever finer list of uncovered cubes (Ebeida et al. 2012).
class MaximalSampler {
 public:
  MaximalSampler(double side, double spacing)
      : side_(side),
        spacing_(spacing),
        // Cubes no wider than spacing / √3 hold one sample at most.
        count_(static_cast<int>(std::ceil(side * std::sqrt(3.0) / spacing))),
        sample_in_(static_cast<std::size_t>(count_) * count_ * count_, -1) {
    for (int z = -2; z <= 2; ++z)
      for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) {
          const IVec3 gap = glm::max(glm::abs(IVec3(x, y, z)) - 1, IVec3(0));
          const double nearest = std::sqrt(static_cast<double>(gap.x + gap.y + gap.z)) * side / count_;
          if (nearest < spacing) offsets_.push_back({x, y, z});
        }
    // Nearest first: what stands in the way of a dart is mostly close to it.
    std::stable_sort(offsets_.begin(), offsets_.end(), [](const IVec3& a, const IVec3& b) {
      return a.x * a.x + a.y * a.y + a.z * a.z < b.x * b.x + b.y * b.y + b.z * b.z;
    });
    for (const IVec3& o : offsets_) steps_.push_back((static_cast<std::ptrdiff_t>(o.z) * count_ + o.y) * count_ + o.x);
  }

  std::vector<Vec3> run(Seed seed, const Task& task) {
    std::vector<IVec3> cubes;
    cubes.reserve(sample_in_.size());
    for (int z = 0; z < count_; ++z)
      for (int y = 0; y < count_; ++y)
        for (int x = 0; x < count_; ++x) cubes.push_back({x, y, z});
    for (int level = 0; level <= kMaxLevel && !cubes.empty(); ++level) {
      task.check();
      Rng rng(seed, "samples", static_cast<std::uint64_t>(level));
      throw_darts(cubes, level, rng);
      cubes = uncovered_children(cubes, level);
    }
    return std::move(samples_);
  }

 private:
  void throw_darts(const std::vector<IVec3>& cubes, int level, Rng& rng) {
    const auto darts = static_cast<std::size_t>(kDartsPerCube * static_cast<double>(cubes.size())) + 1;
    const double width = side_ / count_ / static_cast<double>(1 << level);
    for (std::size_t dart = 0; dart < darts; ++dart) {
      const IVec3 cube = cubes[rng.below(cubes.size())];
      const double x = rng.uniform();
      const double y = rng.uniform();
      const double z = rng.uniform();
      const IVec3 base = cube >> level;
      if (at(base) >= 0) continue;
      const Vec3 p = (Vec3(cube) + Vec3(x, y, z)) * width;
      if (p.x >= side_ || p.y >= side_ || p.z >= side_ || !is_free(p, base)) continue;
      at(base) = static_cast<std::int32_t>(samples_.size());
      samples_.push_back(p);
    }
  }

  std::vector<IVec3> uncovered_children(const std::vector<IVec3>& cubes, int level) {
    const double half = side_ / count_ / static_cast<double>(2 << level) / 2.0;
    const double reach = spacing_ * spacing_;
    std::vector<IVec3> children;
    std::vector<Vec3> around;  // the samples around `around_base`, unwrapped: cubes of one base follow each other
    std::vector<Vec3> near;
    IVec3 around_base(-1);
    for (const IVec3& cube : cubes) {
      const IVec3 base = cube >> level;
      if (at(base) >= 0) continue;
      const Vec3 middle = (2.0 * Vec3(cube) + 1.0) * (2.0 * half);
      if (base != around_base) {
        around_base = base;
        around.clear();
        visit_around(base, [&](const Vec3& p) {
          around.push_back(p);
          return true;
        });
      }
      // The middle is a corner of every child: a sample that covers a child covers it.
      near.clear();
      for (const Vec3& p : around)
        if (const Vec3 d = p - middle; glm::dot(d, d) < reach) near.push_back(d);
      for (int corner = 0; corner < 8; ++corner) {
        const IVec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
        const Vec3 offset = (2.0 * Vec3(step) - 1.0) * half;
        bool covered = false;
        for (std::size_t i = 0; i < near.size() && !covered; ++i) {
          const Vec3 far = glm::abs(near[i] - offset) + half;  // to the corner farthest from the sample
          covered = glm::dot(far, far) < reach;
        }
        if (!covered) children.push_back(2 * cube + step);
      }
    }
    return children;
  }

  [[nodiscard]] bool is_free(const Vec3& p, const IVec3& base) const {
    return visit_around(base, [&](const Vec3& q) {
      const Vec3 d = q - p;
      return glm::dot(d, d) >= spacing_ * spacing_;
    });
  }

  // Calls `visit(sample)` for what may lie within the spacing of a cube, until it returns false. The sample is moved by
  // whole tiles to lie beside the cube.
  template <class F>
  bool visit_around(const IVec3& base, F&& visit) const {
    const bool is_inner =
        glm::min(base.x, glm::min(base.y, base.z)) >= 2 && glm::max(base.x, glm::max(base.y, base.z)) < count_ - 2;
    if (is_inner) {  // the common case, without wrapping: half of the time goes here
      const std::int32_t* const cell = &sample_in_[index(base)];
      for (const std::ptrdiff_t step : steps_)
        if (const std::int32_t i = cell[step]; i >= 0)
          if (!visit(samples_[static_cast<std::size_t>(i)])) return false;
      return true;
    }
    for (const IVec3& offset : offsets_) {
      const IVec3 c = wrapped(base + offset);
      if (const std::int32_t i = sample_in_[index(c)]; i >= 0) {
        const IVec3 tiles = (base + offset - c) / count_;
        if (!visit(samples_[static_cast<std::size_t>(i)] + side_ * Vec3(tiles))) return false;
      }
    }
    return true;
  }

  [[nodiscard]] IVec3 wrapped(IVec3 c) const {
    for (int axis = 0; axis < 3; ++axis) c[axis] += c[axis] < 0 ? count_ : c[axis] >= count_ ? -count_ : 0;
    return c;
  }
  [[nodiscard]] std::size_t index(const IVec3& c) const {
    return (static_cast<std::size_t>(c.z) * count_ + c.y) * count_ + c.x;
  }
  [[nodiscard]] std::int32_t& at(const IVec3& c) { return sample_in_[index(c)]; }

  double side_;
  double spacing_;
  int count_;
  std::vector<std::int32_t> sample_in_;
  std::vector<IVec3> offsets_;         // Cubes around a cube that may hold a sample within the spacing.
  std::vector<std::ptrdiff_t> steps_;  // The same as steps in sample_in_.
  std::vector<Vec3> samples_;
};

}  // namespace

Vec3 wrapped_difference(const Vec3& a, const Vec3& b, double side) noexcept {
  const Vec3 d = b - a;
  return {d.x - side * std::floor(d.x / side + 0.5), d.y - side * std::floor(d.y / side + 0.5),
          d.z - side * std::floor(d.z / side + 0.5)};
}

double wrapped_distance(const Vec3& a, const Vec3& b, double side) noexcept {
  return glm::length(wrapped_difference(a, b, side));
}

std::vector<Vec3> poisson_samples(double side, double spacing, Seed seed, const Task& task) {
  require(std::isfinite(side) && side > 0.0, "side", "> 0 and finite", side);
  require(spacing > 0.0 && spacing <= side / 4.0, "spacing", "in (0, side / 4]", spacing);
  require(spacing >= side / kFinestSpacing, "spacing", "at least side / 160", spacing);
  return MaximalSampler(side, spacing).run(seed, task);
}

Graph neighbour_graph(const std::vector<Vec3>& samples, double side, double radius) {
  require(radius > 0.0 && radius < side / 2.0, "radius", "in (0, side / 2)", radius);
  WrappedGrid grid(side, radius);
  for (const Vec3& p : samples) grid.insert(p);
  Graph graph;
  graph.first.reserve(samples.size() + 1);
  graph.first.push_back(0);
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    grid.visit_near(samples[i], [&](std::uint32_t j) {
      const Vec3 d = wrapped_difference(samples[i], samples[j], side);
      if (j != i && glm::dot(d, d) <= radius * radius) graph.targets.push_back(j);
    });
    graph.first.push_back(static_cast<std::uint32_t>(graph.targets.size()));
  }
  return graph;
}

}  // namespace outcrop

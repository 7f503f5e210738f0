#include "outcrop/fracture/samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/vector_relational.hpp>

#include "cell_grid.h"
#include "outcrop/core/error.h"
#include "outcrop/core/simd.h"
#include "wrapped_grid.h"

namespace outcrop {
namespace {

constexpr int kReach = CellGrid::kReach;
constexpr int kHalo = 4;     // Cells beyond each border, for images of samples near the other: reach, and whole blocks.
constexpr int kSweeps = 16;  // Of single darts into cubes that may have room, before gaps are searched.
constexpr int kFirstShare = 8;  // The first two sweeps throw at one open cube in 2⁸, the next two at one in 2⁷, …
constexpr int kMaxHalvings = 20;  // To cubes of a millionth of the spacing: what is left uncovered then is rounding.

/// Eight floats: one register of AVX, two of SSE2. Lane by lane, so the bits are the same.
using Eight [[gnu::vector_size(8 * sizeof(float))]] = float;
using EightInts [[gnu::vector_size(8 * sizeof(float))]] = std::int32_t;

/// Samples that reach a cube, from its lower corner.
struct Near {
  // Balls of half the spacing around them do not overlap and lie within 1.5 spacings of the cube: 40 at most.
  static constexpr int kMost = 64;
  int count = 0;
  float x[kMost], y[kMost], z[kMost];
};

struct Cube {
  float x, y, z;  // The lower corner.
};

struct Darts {
  float x[8], y[8], z[8];
};

[[gnu::always_inline]] inline Eight load(const float* from) {
  Eight v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

[[gnu::always_inline]] inline Eight magnitude(const Eight& v) { return (Eight)((EightInts)v & 0x7FFFFFFF); }

// Whether one sample covers all of a cube of half-width `half`, for eight centres: a bit each. Points for a half of 0.
[[gnu::always_inline]] inline unsigned covered(const Near& near, const Eight& x, const Eight& y, const Eight& z,
                                               float half, float reach) {
  Eight least = Eight{} + 1e30f;
  for (int i = 0; i < near.count; ++i) {
    const Eight dx = magnitude(x - near.x[i]) + half;  // to the farthest corner
    const Eight dy = magnitude(y - near.y[i]) + half;
    const Eight dz = magnitude(z - near.z[i]) + half;
    const Eight d = dx * dx + dy * dy + dz * dz;
    least = d < least ? d : least;
  }
  unsigned bits = 0;
  for (int lane = 0; lane < 8; ++lane) bits |= unsigned{least[lane] < reach} << lane;
  return bits;
}

// The children of a cube, x running fastest, that a single sample covers. `quarter`: of the cube's width.
OUTCROP_SIMD_CLONES unsigned covered_children(const Near& near, const Cube& cube, float quarter, float reach) {
  constexpr Eight kX{1, 3, 1, 3, 1, 3, 1, 3}, kY{1, 1, 3, 3, 1, 1, 3, 3}, kZ{1, 1, 1, 1, 3, 3, 3, 3};
  return covered(near, kX * quarter + cube.x, kY * quarter + cube.y, kZ * quarter + cube.z, quarter, reach);
}

OUTCROP_SIMD_CLONES unsigned covered_darts(const Near& near, const Darts& darts, float reach) {
  return covered(near, load(darts.x), load(darts.y), load(darts.z), 0.0f, reach);
}

// A point of [0, 1)³, in floats without rounding.
Vec3f draw_point(Rng& rng) {
  const std::uint64_t bits = rng.next();
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  return Vec3f(bits & kMask, bits >> 21 & kMask, bits >> 42 & kMask) * 0x1.0p-21f;
}

// All bits with a probability of 2⁻ˢʰᵃʳᵉ.
std::uint64_t draw_bits(Rng& rng, int share) {
  std::uint64_t bits = ~std::uint64_t{0};
  for (int i = 0; i < share; ++i) bits &= rng.next();
  return bits;
}

// Maximal Poisson-disc sampling. As in Ebeida et al. 2012, darts go only where there may be room, cubes that no single
// sample covers; but the list of these cubes is a set of bits, kept up to date by every sample, and what the darts
// leave is halved and searched cube by cube. All passes run through memory in order, so that the cost a sample does not
// grow.
//
// Lengths are in cells. Positions are exact: their images are whole cells away.
class MaximalSampler {
 public:
  MaximalSampler(double side, double spacing)
      : side_(side),
        // Cells no wider than spacing / √3 hold one sample at most. At a side of four spacings or more they are wider
        // than half the spacing, so that kReach suffices.
        count_(static_cast<int>(std::ceil(side * std::sqrt(3.0) / spacing))),
        // By a little more than the spacing, so that rounding to metres does not break it.
        reach_(spacing * spacing * count_ * count_ / (side * side) * (1.0 + 1e-12)),
        grid_(count_ + 2 * kHalo),
        open_(2 * (count_ + 2 * kHalo)) {
    for (int z = 0; z < 2 * count_; ++z)
      for (int y = 0; y < 2 * count_; ++y)
        for (int x = 0; x < 2 * count_; ++x) open_.insert(IVec3(x, y, z) + 2 * kHalo);
  }

  std::vector<Vec3> run(Seed seed, const Task& task) {
    // Few darts at first: a sweep that filled the tile from one end to the other would pack it more tightly.
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      task.check();
      Rng rng(seed, "samples", static_cast<std::uint64_t>(sweep));
      const int share = std::max(1, kFirstShare - sweep / 2);
      open_.visit([&] { return draw_bits(rng, share); },
                  [&](const IVec3& cube) {
                    const Vec3 p = 0.5 * (Vec3(cube) + Vec3(draw_point(rng)));
                    insert_if_free(cube >> 1, p);
                  });
    }
    task.check();
    Rng rng(seed, "samples", kSweeps);
    open_.visit([] { return ~std::uint64_t{0}; }, [&](const IVec3& cube) { search(cube, rng); });
    return samples();
  }

 private:
  bool insert_if_free(const IVec3& cell, const Vec3& p) {
    const bool is_free = grid_.visit_around(cell, [&](const Vec3& q) {
      const Vec3 d = q - p;
      return glm::dot(d, d) >= reach_;
    });
    if (!is_free || glm::any(glm::greaterThanEqual(p, Vec3(count_ + kHalo)))) return false;  // beyond by rounding
    const IVec3 lo(glm::greaterThanEqual(cell, IVec3(count_ + kHalo - kReach)));
    const IVec3 hi(glm::lessThan(cell, IVec3(kHalo + kReach)));
    for (int z = -lo.z; z <= hi.z; ++z)
      for (int y = -lo.y; y <= hi.y; ++y)
        for (int x = -lo.x; x <= hi.x; ++x) {
          const IVec3 turn = count_ * IVec3(x, y, z);
          grid_.insert(cell + turn, p + Vec3(turn));
          close_around(p + Vec3(turn));
        }
    return true;
  }

  // Takes out the cubes that the sample covers: none is more than kFar cubes away, as 2 √reach_ < 4.
  void close_around(const Vec3& p) {
    constexpr int kFar = 3;
    const Vec3 q = 2.0 * p;
    const IVec3 cube(q);
    float far[3][2 * kFar + 1];  // squares of the distances to the farther sides of the cubes, in cubes
    for (int axis = 0; axis < 3; ++axis)
      for (int i = -kFar; i <= kFar; ++i) {
        const auto d = static_cast<float>(std::abs(q[axis] - (cube[axis] + i + 0.5)) + 0.5);
        far[axis][i + kFar] = d * d;
      }
    const auto reach = static_cast<float>(4.0 * reach_);
    for (int z = 0; z <= 2 * kFar; ++z)
      for (int y = 0; y <= 2 * kFar; ++y) {
        const float rest = reach - far[2][z] - far[1][y];
        if (rest <= 0.0f) continue;
        std::uint64_t covered = 0;
        for (int x = 0; x <= 2 * kFar; ++x) covered |= std::uint64_t{far[0][x] < rest} << x;
        open_.erase(cube + IVec3(0, y, z) - kFar, covered);
      }
  }

  // A sample in what no other covers of the cube, evenly over it, if there is any.
  void search(const IVec3& start, Rng& rng) {
    const IVec3 cell = start >> 1;
    const Vec3 corner = 0.5 * Vec3(start);
    const auto reach = static_cast<float>(reach_);
    collect_near(cell, corner);
    cubes_.assign(1, Cube{0.0f, 0.0f, 0.0f});
    float width = 0.5f;
    for (int halving = 0; halving < kMaxHalvings; ++halving) {
      halve_cubes(width);
      width *= 0.5f;
      for (std::size_t thrown = 0; thrown < cubes_.size(); thrown += 8) {
        Darts darts;
        for (int i = 0; i < 8; ++i) {
          const Cube& cube = cubes_[rng.below(cubes_.size())];
          const Vec3f p = draw_point(rng);
          darts.x[i] = cube.x + width * p.x;
          darts.y[i] = cube.y + width * p.y;
          darts.z[i] = cube.z + width * p.z;
        }
        for (unsigned open = ~covered_darts(near_, darts, reach) & 0xFF; open != 0; open &= open - 1) {
          const int i = std::countr_zero(open);
          if (insert_if_free(cell, corner + Vec3(darts.x[i], darts.y[i], darts.z[i]))) return;
        }
      }
      if (cubes_.empty()) return;
    }
  }

  void collect_near(const IVec3& cell, const Vec3& corner) {
    const auto gap = [](float v) { return std::max(std::abs(v - 0.25f) - 0.25f, 0.0f); };
    const auto reach = static_cast<float>(reach_);
    near_.count = 0;
    grid_.visit_around(cell, [&](const Vec3& p) {
      const Vec3f q(p - corner);
      near_.x[near_.count] = q.x;
      near_.y[near_.count] = q.y;
      near_.z[near_.count] = q.z;
      near_.count += gap(q.x) * gap(q.x) + gap(q.y) * gap(q.y) + gap(q.z) * gap(q.z) < reach;
      return true;
    });
  }

  // Puts the children that no single sample covers in the place of the cubes.
  void halve_cubes(float width) {
    children_.clear();
    const float half = 0.5f * width;
    for (const Cube& cube : cubes_) {
      const unsigned covered = covered_children(near_, cube, 0.5f * half, static_cast<float>(reach_));
      for (unsigned open = ~covered & 0xFF; open != 0; open &= open - 1) {
        const int i = std::countr_zero(open);
        children_.push_back({cube.x + half * static_cast<float>(i & 1), cube.y + half * static_cast<float>(i >> 1 & 1),
                             cube.z + half * static_cast<float>(i >> 2)});
      }
    }
    std::swap(cubes_, children_);
  }

  // In metres, block of cells by block of cells: whoever goes through them finds neighbours close by in memory.
  [[nodiscard]] std::vector<Vec3> samples() const {
    std::vector<Vec3> result;
    grid_.visit([&](const IVec3& cell, const Vec3& p) {
      const IVec3 c = cell - kHalo;
      if (std::min({c.x, c.y, c.z}) >= 0 && std::max({c.x, c.y, c.z}) < count_)
        result.push_back((p - double{kHalo}) * (side_ / count_));
    });
    return result;
  }

  double side_;
  int count_;     // Cells along a side.
  double reach_;  // The spacing's square.
  CellGrid grid_;
  CubeSet open_;                        // Cubes of half a cell that no sample covers.
  Near near_;                           // To the cube that is searched.
  std::vector<Cube> cubes_, children_;  // Of that cube, from its lower corner.
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
  const SortedCells cells(samples, side, radius);
  Graph graph;
  graph.first.reserve(samples.size() + 1);
  graph.first.push_back(0);
  std::size_t found = 0;
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    cells.visit_near(samples[i], [&](std::span<const SortedCells::Entry> some, const Vec3& turn) {
      if (graph.targets.size() < found + some.size()) graph.targets.resize(2 * found + some.size());
      const Vec3 from = samples[i] - turn;
      for (const auto& [p, j] : some) {  // without branches: one in six is near enough
        const Vec3 d = p - from;
        graph.targets[found] = j;
        found += static_cast<std::size_t>(j != i) & static_cast<std::size_t>(glm::dot(d, d) <= radius * radius);
      }
    });
    graph.first.push_back(static_cast<std::uint32_t>(found));
  }
  graph.targets.resize(found);
  return graph;
}

}  // namespace outcrop

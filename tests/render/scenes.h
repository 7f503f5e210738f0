/// Fields for the renderer's tests and benchmarks, with answers known in closed form or by brute force.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/field.h"

namespace outcrop::test {

class Ball final : public PointField {
 public:
  Ball(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {}
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override { return glm::length(p - centre_) - radius_; }

 private:
  Vec3 centre_;
  double radius_;
};

/// Rock below a plane through a point.
class Ground final : public PointField {
 public:
  Ground(const Vec3& point, const Vec3& normal) : point_(point), normal_(glm::normalize(normal)) {}
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override { return glm::dot(p - point_, normal_); }
  [[nodiscard]] Vec3 gradient_at(const Vec3&) const noexcept override { return normal_; }

 private:
  Vec3 point_, normal_;
};

/// Rolling ground z = height · sin(x / wave) · cos(y / wave), steep and with L well above 1: the vertical distance.
class Hills final : public PointField {
 public:
  Hills(const Vec3& origin, double height, double wave) : origin_(origin), height_(height), wave_(wave) {}
  [[nodiscard]] double lipschitz() const noexcept override { return std::hypot(1.0, std::sqrt(2.0) * height_ / wave_); }

 protected:
  [[nodiscard]] double at(const Vec3& p) const noexcept override {
    const Vec3 q = p - origin_;
    return q.z - height_ * std::sin(q.x / wave_) * std::cos(q.y / wave_);
  }

 private:
  Vec3 origin_;
  double height_, wave_;
};

/// The union of rounded boxes in any orientation: a pile of blocks. Labels count the blocks, modulo 3.
class BlockPile final : public Field {
 public:
  struct Block {
    Vec3 centre, half;
    Mat3 local_from_world;
    double rounding;
    Label label;
  };
  explicit BlockPile(std::vector<Block> blocks) : blocks_(std::move(blocks)) {}

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t k = nearest(points[i], values[i]);
      if (!gradients.empty()) gradients[i] = k < blocks_.size() ? slope(blocks_[k], points[i]) : Vec3(0, 0, 1);
    }
  }
  [[nodiscard]] double lipschitz() const noexcept override { return 1.0; }
  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    const double radius = box.half_diagonal();
    const double least = value(box.centre()) + radius;
    std::vector<Block> near;
    for (const Block& block : blocks_)
      if (distance(block, box.centre()) - radius <= least) near.push_back(block);
    return std::make_shared<BlockPile>(std::move(near));
  }
  void labels(const Points& points, std::span<Label> labels) const noexcept override {
    double unused = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t k = nearest(points[i], unused);
      labels[i] = k < blocks_.size() ? blocks_[k].label : 0;
    }
  }

 private:
  [[nodiscard]] static double distance(const Block& block, const Vec3& p) noexcept {
    const Vec3 q = glm::abs(block.local_from_world * (p - block.centre)) - (block.half - block.rounding);
    return glm::length(glm::max(q, 0.0)) + std::min(0.0, std::max({q.x, q.y, q.z})) - block.rounding;
  }
  [[nodiscard]] static Vec3 slope(const Block& block, const Vec3& p) noexcept {
    const Vec3 local = block.local_from_world * (p - block.centre);
    const Vec3 q = glm::abs(local) - (block.half - block.rounding);
    Vec3 g = glm::max(q, 0.0);
    if (glm::length(g) == 0.0) g[q.x > q.y ? (q.x > q.z ? 0 : 2) : (q.y > q.z ? 1 : 2)] = 1.0;
    for (int axis = 0; axis < 3; ++axis) g[axis] = std::copysign(g[axis], local[axis]);
    return glm::transpose(block.local_from_world) * glm::normalize(g);
  }
  std::size_t nearest(const Vec3& p, double& best) const noexcept {
    std::size_t index = blocks_.size();
    best = 1e3;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const double d = distance(blocks_[k], p);
      if (d < best) best = d, index = k;
    }
    return index;
  }

  std::vector<Block> blocks_;
};

/// Blocks of 1 to 3 m on a jittered lattice around `centre`, turned at random: overlapping, with cracks between.
inline FieldPtr block_pile(const Vec3& centre, const IVec3& count, Seed seed) {
  std::vector<BlockPile::Block> blocks;
  for (int k = 0; k < count.z; ++k)
    for (int j = 0; j < count.y; ++j)
      for (int i = 0; i < count.x; ++i) {
        Rng rng(seed, "pile", blocks.size());
        const Vec3 jitter = 0.5 * rng.direction();
        const Vec3 x = glm::normalize(Vec3(1, 0, 0) + 0.5 * rng.direction());
        const Vec3 y = glm::normalize(glm::cross(Vec3(0, 0, 1) + 0.3 * rng.direction(), x));
        const double a = rng.uniform(0.6, 1.4), b = rng.uniform(0.6, 1.4), c = rng.uniform(0.6, 1.4);
        const Vec3 lattice = 2.0 * (Vec3(i, j, k) - 0.5 * Vec3(count - 1));
        blocks.push_back({.centre = centre + lattice + jitter,
                          .half = {a, b, c},
                          .local_from_world = glm::transpose(Mat3(x, y, glm::cross(x, y))),
                          .rounding = 0.1,
                          .label = static_cast<Label>(blocks.size() % 3)});
      }
  return std::make_shared<BlockPile>(std::move(blocks));
}

}  // namespace outcrop::test

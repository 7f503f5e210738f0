#include "leaves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "outcrop/core/parallel.h"

namespace outcrop::render {
namespace {

constexpr double kOverlap = 1e-6;        // Of a leaf's size: what neighbouring leaves share.
constexpr double kOutOfViewScale = 3.0;  // Leaves that only shadows see are so much coarser.
constexpr int kUnseenLevels = 3;
constexpr std::size_t kSurfaceParts = 4;  // A surface crosses some 4 of a cube's 8 parts.
constexpr double kCubeRatio = 0.7;       // Sides longer than this share of the longest are halved.

struct Node {
  Box box;  // Without the overlap: nodes of one level tile the region.
  FieldPtr field;
};

/// Children that may hold surface: those to go on with and those that are done.
struct Split {
  std::vector<Node> nodes;
  std::vector<Leaf> leaves;
};

double longest_side(const Box& box) {
  const Vec3 size = box.size();
  return std::max({size.x, size.y, size.z});
}

double distance_to(const Box& box, const Vec3& p) {
  return glm::length(p - glm::clamp(p, box.lo, box.hi));
}

bool touches_sides(const Box& box, const Box& region) {
  for (int axis = 0; axis < 3; ++axis)
    if (box.lo[axis] <= region.lo[axis] || box.hi[axis] >= region.hi[axis]) return true;
  return false;
}

/// Whether the box's bounding ball reaches into the cone of view.
bool in_view(const Box& box, const TracerOptions& options) {
  const Vec3 to_box = box.centre() - options.eye;
  const double distance = glm::length(to_box), radius = box.half_diagonal();
  if (distance <= radius) return true;
  const double angle = std::acos(std::clamp(glm::dot(to_box, options.view) / distance, -1.0, 1.0));
  return angle <= options.view_angle + std::asin(radius / distance);
}

double wanted_size(const Box& box, const TracerOptions& options) {
  const double seen = options.leaf_widths * options.spread * distance_to(box, options.eye);
  const double size = std::max(options.leaf_details * options.detail, seen);
  return in_view(box, options) ? size : kOutOfViewScale * size;
}

std::vector<Box> halves(const Box& box) {
  const Vec3 size = box.size(), middle = box.centre();
  std::vector<Box> parts{box};
  for (int axis = 0; axis < 3; ++axis) {
    if (size[axis] < kCubeRatio * longest_side(box)) continue;
    const std::size_t count = parts.size();
    for (std::size_t i = 0; i < count; ++i) {
      Box upper = parts[i];
      upper.lo[axis] = middle[axis];
      parts[i].hi[axis] = middle[axis];
      parts.push_back(upper);
    }
  }
  return parts;
}

Leaf leaf_of(const Box& grown, FieldPtr field) {
  const double lipschitz = std::max(field->lipschitz(), 1e-3);
  const Modulus modulus = field->modulus();
  return {grown, std::move(field), lipschitz, {std::max(modulus.slope, 1e-3), modulus.slack}};
}

/// Sorts one box into nodes, leaves or nothing.
void place(const Box& box, const Field& parent, const TracerOptions& options, Split& split) {
  const Box grown = box.grown(kOverlap * longest_side(box));
  const Interval bound = parent.bound(grown);
  if (bound.lo > 0.0) return;
  if (bound.hi < 0.0 && !touches_sides(box, options.region)) return;
  FieldPtr field = parent.narrow(grown);
  if (bound.hi >= 0.0 && longest_side(box) > wanted_size(box, options))
    split.nodes.push_back({box, std::move(field)});
  else
    split.leaves.push_back(leaf_of(grown, std::move(field)));
}

}  // namespace

std::vector<Leaf> build_leaves(const Field& field, const TracerOptions& options, const Task& task) {
  std::vector<Leaf> leaves;
  std::vector<Node> nodes{{options.region, field.shared_from_this()}};
  // The first levels are split unseen: most boxes hold surface, and bounds over many blocks are dear.
  for (int level = 1; level < kUnseenLevels; ++level) {
    std::vector<Node> finer;
    for (Node& node : nodes) {
      if (longest_side(node.box) <= wanted_size(node.box, options)) {
        finer.push_back(std::move(node));
        continue;
      }
      for (const Box& part : halves(node.box)) finer.push_back({part, node.field});
    }
    nodes = std::move(finer);
  }
  while (!nodes.empty()) {
    task.check();
    if (leaves.size() + kSurfaceParts * nodes.size() > options.max_leaves) {
      for (Node& node : nodes)
        leaves.push_back(leaf_of(node.box.grown(kOverlap * longest_side(node.box)), std::move(node.field)));
      break;
    }
    std::vector<Split> splits = parallel_map(
        nodes.size(),
        [&](std::size_t i) {
          Split split;
          const bool small = longest_side(nodes[i].box) <= wanted_size(nodes[i].box, options);
          for (const Box& part : small ? std::vector<Box>{nodes[i].box} : halves(nodes[i].box))
            place(part, *nodes[i].field, options, split);
          return split;
        },
        Task{.stop = task.stop});
    nodes.clear();
    for (Split& split : splits) {
      std::move(split.leaves.begin(), split.leaves.end(), std::back_inserter(leaves));
      std::move(split.nodes.begin(), split.nodes.end(), std::back_inserter(nodes));
    }
  }
  return leaves;
}

}  // namespace outcrop::render

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
  return {grown, std::move(field), lipschitz};
}

/// Sorts one box into nodes, leaves or nothing.
void place(const Box& box, const Field& parent, const TracerOptions& options, Split& split) {
  const Box grown = box.grown(kOverlap * longest_side(box));
  Interval bound = parent.bound(grown);
  if (bound.lo > 0.0) return;
  const auto hidden = [&] { return bound.hi < 0.0 && !touches_sides(box, options.region); };
  if (hidden()) return;
  FieldPtr field = parent.narrow(grown);
  if (bound.hi >= 0.0 && longest_side(box) > wanted_size(box, options)) {
    split.nodes.push_back({box, std::move(field)});
    return;
  }
  bound = outcrop::intersection(bound, field->bound(grown));  // Often tighter for the narrowed field.
  if (bound.lo <= 0.0 && !hidden()) split.leaves.push_back(leaf_of(grown, std::move(field)));
}

}  // namespace

std::vector<Leaf> build_leaves(const Field& field, const TracerOptions& options, const Task& task) {
  Split level;
  place(options.region, field, options, level);
  std::vector<Leaf> leaves = std::move(level.leaves);
  std::vector<Node> nodes = std::move(level.nodes);
  while (!nodes.empty()) {
    task.check();
    // A surface that crosses a cube crosses about four of its eight parts.
    if (leaves.size() + 4 * nodes.size() > options.max_leaves) {
      for (Node& node : nodes) {
        const Box grown = node.box.grown(kOverlap * longest_side(node.box));
        leaves.push_back(leaf_of(grown, std::move(node.field)));
      }
      break;
    }
    std::vector<Split> splits = parallel_map(
        nodes.size(),
        [&](std::size_t i) {
          Split split;
          for (const Box& part : halves(nodes[i].box)) place(part, *nodes[i].field, options, split);
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

#include "tile_blocks.h"

#include <algorithm>
#include <cmath>

#include "outcrop/core/parallel.h"
#include "outcrop/fracture/hull.h"

namespace outcrop {
namespace {

constexpr double kTolerance = 1e-10;   // Of the side: see clusters.cpp.
constexpr double kLeastPart = 0.1;     // Of the spacing: radius of a ball inside, beside authored blocks.
constexpr double kWeld = 2.0;          // Roundings: how deep parts of one block reach into each other.
constexpr std::size_t kAnchors = 24;

// Points that spread through the block: each is the farthest from those before, the centre counting as the first.
std::vector<Vec3> spread(const std::vector<Vec3>& points, std::size_t count) {
  std::vector<double> room(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) room[i] = glm::dot(points[i], points[i]);
  const auto less = [&](std::size_t a, std::size_t b) {  // ties by place: the order of the samples must not matter
    if (room[a] != room[b]) return room[a] < room[b];
    const Vec3& p = points[a];
    const Vec3& q = points[b];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
  };
  std::vector<Vec3> result;
  while (result.size() < std::min(count, points.size())) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      if (less(best, i)) best = i;
    result.push_back(points[best]);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 d = points[i] - result.back();
      room[i] = std::min(room[i], glm::dot(d, d));
    }
    room[best] = -1.0;
  }
  return result;
}

bool holds(const std::vector<Plane>& planes, const Vec3& p) {
  return std::ranges::all_of(planes, [&](const Plane& plane) { return plane.distance(p) <= 0.0; });
}

// Around the centre of its largest ball; without anchors.
Block block_of(Polytope shape, const TileOptions& options) {
  Block block;
  const Ball ball = inscribed_ball(shape);
  block.home = ball.centre;
  block.inradius = ball.radius;
  block.rounding = std::min(options.rounding, 0.5 * ball.radius);
  block.centre = ball.centre - options.side * glm::floor(ball.centre / options.side);
  for (int axis = 0; axis < 3; ++axis)
    if (block.centre[axis] >= options.side) block.centre[axis] = 0.0;  // floor of a tiny negative number
  for (const Polytope::Face& face : shape.faces)
    block.planes.push_back({face.plane.normal, face.plane.distance(ball.centre)});
  for (const Polytope::Face& face : shape.faces) block.plane_joint.push_back(face.joint);
  for (Vec3& v : shape.vertices) v -= ball.centre;
  block.bounds = shape.bounds();
  block.hull = convex_hull(shape.vertices).value();
  block.volume = volume(block.hull);
  return block;
}

// The parts of one block, which share what decides on its presence.
// @param positions  Of samples that may lie in it.
std::vector<Block> blocks_of(CutCell piece, const std::vector<Vec3>& positions, const TileOptions& options) {
  std::vector<Block> parts;
  for (Polytope& shape : piece.parts) {
    parts.push_back(block_of(std::move(shape), options));
    Block& block = parts.back();
    block.part = static_cast<std::uint32_t>(parts.size() - 1);
    block.parts = static_cast<std::uint32_t>(piece.parts.size());
    if (block.parts > 1) block.volume = piece.volumes[block.part];
  }
  const Vec3 origin = parts[0].home;
  std::vector<Vec3> inside;
  for (const Vec3& p : positions)
    if (std::ranges::any_of(parts, [&](const Block& part) { return holds(part.planes, p - part.home); }))
      inside.push_back(p - origin);
  std::vector<Vec3> anchors = spread(inside, kAnchors);
  if (anchors.empty()) anchors.push_back(Vec3(0.0));
  const Vec3 shift = parts[0].centre - origin;  // whole tiles
  for (Block& part : parts) {
    for (const Vec3& anchor : anchors) part.anchors.push_back(anchor + (origin - part.home));
    part.sample_count = static_cast<std::uint32_t>(inside.size());
    // All parts stand in one copy of the tile.
    if (options.variants == 1) part.home = part.part == 0 ? part.centre : part.home + shift;
  }
  return parts;
}

template <class Visit>
void visit_images(const Box& of, const Box& box, const TileOptions& options, Visit&& visit) {
  if (options.domain == Domain::Box) {
    if (of.overlaps(box)) visit(Vec3(0.0));
    return;
  }
  const Vec3 lo = glm::ceil((box.lo - of.hi) / options.side), hi = glm::floor((box.hi - of.lo) / options.side);
  for (double z = lo.z; z <= hi.z; ++z)
    for (double y = lo.y; y <= hi.y; ++y)
      for (double x = lo.x; x <= hi.x; ++x) visit(options.side * Vec3(x, y, z));
}

std::vector<Block> blocks_of(const Cluster& cell, const std::vector<Polytope>& obstacles, double least_part,
                             const TileOptions& options) {
  const double back = 0.5 * options.aperture;
  const double tolerance = kTolerance * options.side;
  Polytope shape = box_polytope(cell.shape.bounds().grown(1.0));
  for (const Polytope::Face& face : cell.shape.faces)
    shape = clipped(shape, {face.plane.normal, face.plane.offset + back}, face.joint, tolerance);
  std::vector<Polytope> near;
  for (const Polytope& obstacle : obstacles)
    visit_images(obstacle.bounds(), shape.bounds(), options,
                 [&](const Vec3& shift) { near.push_back(moved(obstacle, shift)); });
  std::vector<Block> blocks;
  for (CutCell& piece : cut_around(shape, near, least_part, tolerance))
    for (Block& block : blocks_of(std::move(piece), cell.positions, options)) {
      block.layer = cell.layer;
      blocks.push_back(std::move(block));
    }
  if (near.empty()) blocks[0].sample_count = static_cast<std::uint32_t>(cell.samples.size());
  return blocks;
}

std::vector<Block> blocks_of(const AuthoredBlock& authored, const std::vector<Vec3>& samples,
                             const TileOptions& options) {
  const double tolerance = kTolerance * options.side;
  Box bounds;
  for (const Polytope& part : authored.parts) bounds = hull(bounds, part.bounds());
  std::vector<Vec3> positions;
  for (const Vec3& p : samples)
    visit_images({p, p}, bounds, options, [&](const Vec3& shift) { positions.push_back(p + shift); });
  std::vector<Polytope> parts = welded(authored.parts, kWeld * options.rounding, tolerance);
  for (Polytope& part : parts)
    for (Polytope::Face& face : part.faces) face.joint = kAuthoredJoint;
  return blocks_of(without_covered(std::move(parts), tolerance), positions, options);
}

}  // namespace

std::vector<Block> make_blocks(const std::vector<Cluster>& cells, const std::vector<Vec3>& samples,
                               const TileOptions& options, double spacing, const Task& task) {
  std::vector<Polytope> obstacles;
  for (const AuthoredBlock& block : options.blocks)
    for (const Polytope& part : block.parts)
      obstacles.push_back(grown(part, options.aperture, kTolerance * options.side));
  const double least_part = std::max(kLeastPart * spacing, 0.5 * options.aperture);
  const auto of_cells = parallel_map(
      cells.size(), [&](std::size_t i) { return blocks_of(cells[i], obstacles, least_part, options); }, task);
  std::vector<Block> blocks;
  for (const std::vector<Block>& list : of_cells) blocks.insert(blocks.end(), list.begin(), list.end());
  for (const AuthoredBlock& authored : options.blocks)
    for (Block& block : blocks_of(authored, samples, options)) blocks.push_back(std::move(block));
  return blocks;
}

}  // namespace outcrop

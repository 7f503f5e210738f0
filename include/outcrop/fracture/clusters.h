/// Clusters: the samples of a periodic cube, parted by joints into convex pieces that tile space.
#pragma once

#include <cstdint>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/core/task.h"
#include "outcrop/fracture/joints.h"
#include "outcrop/fracture/polytope.h"
#include "outcrop/fracture/samples.h"
#include "outcrop/fracture/tile_layout.h"

namespace outcrop {

/// Samples that no joint parts, and the cell of the tiling that holds them.
struct Cluster {
  Polytope shape;                      ///< Face.joint: index of the disc, or kAddedJoint, kColumnJoint, ….
  std::vector<std::uint32_t> samples;  ///< In the order of the input.
  std::vector<Vec3> positions;         ///< Of the samples, each moved by whole tiles into `shape`.
  int layer = 0;                       ///< Of the tile's layout, where variants share one.
};

struct ClusterOptions {
  double side = 20.0;
  double sight = 1.2;          ///< Metres: two samples within it see each other; the graph's radius.
  int min_samples = 12;        ///< A joint ends rather than part fewer samples from a cluster; 0: no matter.
  double min_inradius = 0.2;   ///< Metres: nor does it part off a piece without room for a ball of this radius; 0: may be.
  double covered_share = 0.0;  ///< See JointPattern.
  double least_angle = 0.0;    ///< See JointPattern.
  double longest = 19.0;       ///< Metres along x, y or z; joints are added to halve longer cells.
  std::vector<ColumnTier> columns{};  ///< See JointPattern; on the torus only.
  std::vector<JointSet> sets{};       ///< What Disc::set refers to: where joints end, and which persistent ones there are.
  bool boxed_columns = false;         ///< Flat joints bound the tile's columns, so that other tiles fit beside it.
  Domain domain = Domain::Torus;      ///< In a box no joint is turned or added, and its walls are faces (kWall).
};

struct Clusters {
  std::vector<Cluster> list;
  std::vector<Disc> discs;  ///< Those given, with their normals as given, then the persistent joints that were made.
  std::size_t stopped_joints = 0;  ///< Joints that ended because they would have cut off a chip.
  std::size_t added_joints =
      0;  ///< Joints that no disc stands for; they keep pieces from wrapping, or from being too long.
  double largest_bend = 0.0;  ///< Largest turn of a disc's normal, radians.
};

/// Splits the torus by joints until every disc has been heard: convex cells that tile space, every sample in one of
/// them.
///
/// A disc that parts samples which see each other through it grows inside their cell until it splits the cell; larger
/// discs come first, so that smaller joints end at larger ones. Each cell is bounded by planes of joints alone,
/// neighbours share them, and no cell meets itself around the torus. On a torus a plane closes only when its normal is
/// a small whole vector: the first joint is turned to the nearest one, the second is turned about one axis only, all
/// others keep their planes. See docs/decisions/fracture.md. The cells do not depend on the order of the samples.
///
/// Persistent sets cut everything up to what they end at: within each compartment that those joints bound, joints stand
/// at distances by the set's law, and another compartment has joints of its own.
///
/// @param samples  None in a tile that geometry alone may split: then persistent joints do, discs do not.
/// @param discs  Older ones first, then larger ones, as draw_discs returns them.
/// @throws ParameterError for columns in a box, a graph of another size, or sets that end at unknown ones.
/// Cost: O(samples · discs that reach their cluster), plus O(discs · cells that do not yet wrap).
[[nodiscard]] Clusters split_samples(const std::vector<Vec3>& samples, const Graph& graph,
                                     const std::vector<Disc>& discs, const ClusterOptions& options, Seed seed,
                                     const Task& task = {});

/// One way to split a tile: what split_samples is given.
struct Drawn {
  std::vector<Disc> discs;
  Seed seed = 0;
};
/// Tiles that fit side by side, and how.
struct TileVariants {
  TileLayout layout;
  std::vector<Clusters> others;
};

/// Splits the torus as often as there are `others`, so that all results and that of `base` have the same regions: the
/// joints that close the torus are the base's (and stand in for the nearest discs of the same set in the others); what
/// cuts the inside of a region is each one's own. With columns, which must be boxed, each has its own columns.
///
/// Cost: that of split_samples for each.
[[nodiscard]] TileVariants split_variants(const std::vector<Vec3>& samples, const Graph& graph, const Drawn& base,
                                          const std::vector<Drawn>& others, const ClusterOptions& options,
                                          const Task& task = {});

}  // namespace outcrop

/// The fracture tile: a periodic cube of rock, split into convex blocks.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/core/rng.h"
#include "outcrop/core/task.h"
#include "outcrop/fracture/authored_blocks.h"
#include "outcrop/fracture/joints.h"
#include "outcrop/fracture/tile_layout.h"
#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop {

/// Default sample spacings a tile: 14 500 samples, the setting of Table 1 of Paris et al. 2020.
inline constexpr double kSpacingsPerSide = 27.04;

struct TileOptions {
  BlockType type = BlockType::Equidimensional;
  JointPattern pattern{};         ///< Neither sets, columns nor discs by hand: joint_pattern(type, side).
  double side = 20.0;             ///< Metres, > 0.
  double spacing = 0.0;           ///< Sample spacing, metres; 0: side / kSpacingsPerSide.
  double neighbour_factor = 1.6;  ///< Graph radius over spacing, [1, 4].
  double aperture = 0.04;         ///< Width of a crack, metres, ≥ 0 and below the spacing.
  double rounding = 0.25;         ///< R of the smooth intersection; limited by half of a block's inradius.
  int min_block_samples = 12;     ///< A joint stops rather than cut off a chip of fewer samples; 1: chips stay.
  int variants = 1;               ///< 1: the tile repeats. More: that many tiles that fit side by side, up to 256.
  /// Blocks that stand as they are given; cells are cut around them, an aperture away. Such a tile has one variant.
  std::vector<AuthoredBlock> blocks{};
  Domain domain = Domain::Torus;  ///< A box is for measuring: its blocks end at walls (kWall) and do not tile.
};

/// A triangle mesh of one convex block, relative to the block's centre; counter-clockwise from outside.
struct BlockMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// One convex block, or a part of one that is not. Positions are relative to `centre`, metres, in the tile's axes.
struct Block {
  Vec3 centre{0.0};           ///< In [0, side)³. The block may reach across the faces: it is one block all the same.
  std::vector<Plane> planes;  ///< In a fixed order; each bounds a face.
  std::vector<int> plane_joint;  ///< Of each plane: index into Tile::discs, or kAddedJoint, kColumnJoint, ….
  double rounding = 0.0;      ///< R for this block.
  double inradius = 0.0;      ///< Of the largest ball found around the centre.
  Box bounds;                 ///< Of the planes' polytope, unrounded.
  BlockMesh hull;             ///< CGAL's hull of the polytope's vertices.
  double volume = 0.0;        ///< Of the hull, m³; of a part: of what no part before it holds.
  std::vector<Vec3> anchors;  ///< Spread through the block, for presence: some 8 to 32 of its samples.
  std::uint32_t sample_count = 0;
  int layer = 0;   ///< Of the tile's layout.
  /// This is part `part` of `parts` that overlap and stand in a row: one block, with the anchors of all of it.
  std::uint32_t part = 0, parts = 1;
  Vec3 home{0.0};  ///< The centre in the base copy of its region: `centre` and whole tiles, where those are its period.
};

/// The joints of one set, as area in a volume (P32), 1/m.
struct SetIntensity {
  std::string name{};
  double asked = 0.0;  ///< 0: the set went by share.
  double drawn = 0.0;  ///< Of its discs, Σ π r² / side³; 0 for persistent sets.
  double made = 0.0;   ///< Of the faces between blocks along its joints.
};

/// What happened on the way, for reports; compare with Table 1 of the paper.
struct TileStatistics {
  std::size_t samples = 0, discs = 0, clusters = 0;
  std::vector<SetIntensity> intensities;  ///< Of each joint set.
  std::size_t merged_chips = 0;  ///< Chips that stay with their block, because the joint ends instead of parting them.
  std::size_t added_joints = 0;  ///< Joints that no disc stands for; without them pieces would wrap around the tile.
  double largest_bend = 0.0;     ///< Largest turn of a disc's normal that made it close around the tile, radians.
  double seconds = 0.0;
  double filled_share = 0.0;   ///< Of the cube, by blocks; from volumes.
  double overlap_share = 0.0;  ///< Of the cube covered twice or more, by random points.
  double mean_planes = 0.0;
  std::size_t max_planes = 0;
  double plain_filled_share = 0.0;  ///< The same for plain hulls of the clusters, without snapping to joints.
  double plain_mean_planes = 0.0;
  std::size_t plain_max_planes = 0;
};

/// Blocks that tile space when repeated with period `side` along the three axes; with variants, when arranged by the
/// layout.
struct Tile {
  double side = 20.0;
  BlockType type = BlockType::Equidimensional;
  double aperture = 0.0;  ///< Of cracks: half of it lies before each face, metres.
  Domain domain = Domain::Torus;
  std::vector<Block> blocks;
  /// The discs as they cut, first as many as were drawn, in their order: one that was turned to close around the tile
  /// has the turned normal; one that was turned in several ways stands once for each. `Disc::set` indexes `sets`.
  std::vector<Disc> discs;
  std::vector<JointSet> sets;  ///< The joint sets as asked for.
  TileLayout layout;           ///< How copies stand side by side.
  /// The blocks of the other variants, which may stand in a copy instead of `blocks`; their plane_joint is empty.
  std::vector<std::vector<Block>> others;
  TileStatistics statistics;
};

/// Edges of the box that has the mesh's volume moments: longest, middle, shortest, metres. For a box, its edges.
[[nodiscard]] std::array<double, 3> principal_sizes(const BlockMesh& mesh) noexcept;

/// Makes a tile. Same options and seed: the same blocks, on every machine and thread count.
///
/// @throws ParameterError when an option is outside its bound. Cost: O(samples · joints that reach a cluster).
/// Method: Paris et al. 2020 section 4, with decisions 3 to 6 of docs/decisions/fracture.md.
[[nodiscard]] Tile make_tile(const TileOptions& options, Seed seed, const Task& task = {});

}  // namespace outcrop

/// Joints: the fracture discs that split a tile, and the named types of rock that distribute them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/core/vec.h"

namespace outcrop {

/// The block types of Paris et al. 2020, section 4.1 (after Dearman 1991 and Palmström 2001).
enum class BlockType { Equidimensional, Rhombohedral, Polyhedral, Tabular, Columnar, Prismatic };

inline constexpr BlockType kBlockTypes[] = {BlockType::Equidimensional, BlockType::Rhombohedral, BlockType::Polyhedral,
                                            BlockType::Tabular,         BlockType::Columnar,     BlockType::Prismatic};

/// "equidimensional", "rhombohedral", …
[[nodiscard]] std::string_view name(BlockType type) noexcept;

/// What a face of a block lies along, where it is not a disc (discs are numbered from 0).
inline constexpr int kWall = -1;         ///< The border of a box of rock: no joint.
inline constexpr int kAddedJoint = -2;   ///< A joint added because a piece wrapped around the torus or was too long.
inline constexpr int kColumnJoint = -3;  ///< A joint between two columns.
inline constexpr int kTierJoint = -4;    ///< A joint between two tiers of columns.

/// A fracture disc in tile space (a torus of the tile's side).
struct Disc {
  Vec3 centre{0.0};
  double radius = 0.0;   ///< Metres.
  Vec3 normal{0, 0, 1};  ///< Unit.
  int set = -1;          ///< Joint set it was drawn from; -1: irregular.
};

/// A family of discs about one mean orientation.
struct JointSet {
  std::string name{};      ///< For reports; one that refers to another set calls it by name.
  Vec3 normal{0, 0, 1};    ///< Mean normal in tile space, unit (z: bedding normal).
  double kappa = 300.0;    ///< Fisher concentration about the normal, > 0; angular deviation is about 81°/√κ.
  double share = 1.0;      ///< Relative number of discs.
  double radius_lo = 5.0;  ///< Metres at a 20 m tile; scaled with the tile's side.
  double radius_hi = 5.0;
  /// a of a radius density ∝ r^−(a+1) on [radius_lo, radius_hi], as fracture networks are fitted; 0: uniform.
  double radius_exponent = 0.0;
};

/// How one type distributes its joints in a tile of 20 m.
struct JointPattern {
  std::vector<JointSet> sets;
  int discs = 15;                ///< Number of discs in all.
  double irregular_share = 0.0;  ///< Share of the discs whose normals are uniform on the sphere.
  double centre_spacing = 2.0;   ///< Smallest distance between disc centres (of one set), metres at 20 m.
  double column_width = 0.0;     ///< > 0: columns of this mean width along z first (Voronoi cells), then the sets.
  /// A disc splits a block that it enters when it covers at least this share of the cut, [0, 1]: at 0 a joint grows
  /// from the least touch, at 1 it never grows beyond its disc.
  double covered_share = 0.0;
  /// The stress shadow of joints: none forms where it would part off a piece thinner than this (the diameter of its
  /// largest ball), metres at 20 m. 0: as thin as the samples can tell.
  double least_thickness = 0.0;
  double least_angle = radians(20.0);  ///< Nor where it would meet another joint at less than this angle, [0, π/3].
};

/// The pattern that stands for a type; numbers and sources in joints.cpp.
[[nodiscard]] JointPattern joint_pattern(BlockType type);

/// Draws the discs of a pattern in a tile of `side` metres; largest radius first, ties in draw order.
///
/// Discs are dealt to the sets in proportion to their shares. Centres of one set keep their distance on the torus where
/// there is room for it. Disc i has a random stream of its own.
/// @throws ParameterError when the pattern is outside its bounds, see check_pattern.
[[nodiscard]] std::vector<Disc> draw_discs(const JointPattern& pattern, double side, Seed seed);

/// @throws ParameterError for a share, radius, concentration or count that makes no sense.
void check_pattern(const JointPattern& pattern);

/// P32, the area of discs in a volume: Σ π r² / side³, in 1/m.
[[nodiscard]] double intensity(const std::vector<Disc>& discs, double side) noexcept;

/// A unit vector from the Fisher distribution about `mean`: cos θ = 1 + ln(u + (1 − u) e^(−2κ)) / κ.
[[nodiscard]] Vec3 fisher_direction(const Vec3& mean, double kappa, Rng& rng);

}  // namespace outcrop

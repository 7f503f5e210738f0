/// Joints: sets of them as a geologist measures them, the fracture discs drawn from them, and the named types of rock.
#pragma once

#include <optional>
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
inline constexpr int kAuthoredJoint = -5;  ///< The border of an authored block.

/// A fracture disc in tile space (a torus of the tile's side).
struct Disc {
  Vec3 centre{0.0};
  double radius = 0.0;   ///< Metres; of a persistent joint, many sides.
  Vec3 normal{0, 0, 1};  ///< Unit.
  int set = -1;          ///< Joint set it was drawn from; -1: irregular, or placed by hand.
  int age = 0;           ///< Lower is older: cuts first. -1: placed by hand.
  bool ends = false;     ///< Whether it ends at the sets that its set names.
};

/// Distances between neighbouring joints of a set.
enum class SpacingLaw { Fixed, Exponential, Lognormal };

/// Radii of a set's discs. Persistent joints cut everything up to what they end at.
enum class RadiusLaw { Uniform, PowerLaw, Lognormal, Persistent };

/// What directions of a joint set are measured against.
enum class JointFrame {
  Tile,     ///< The tile's axes: z the normal of the bedding, y the lattice's north.
  Bedding,  ///< z the normal of the bedding; north that of the map, turned along with the beds.
  Map       ///< z up, y the map's north: as measured in the field.
};

/// A family of joints about one mean orientation. Lengths in metres.
struct JointSet {
  std::string name{};  ///< For reports; a set that ends at another calls it by name.

  Vec3 normal{0, 0, 1};            ///< Mean normal, unit.
  double kappa = 300.0;            ///< Fisher concentration about the normal, > 0; angular deviation is about 81°/√κ.
  std::vector<Vec3> measured{};    ///< Unit normals: where there are some, joints take them, each as often as the others.
  JointFrame frame = JointFrame::Tile;

  // How many: by spacing where it is > 0, else by P32 where that is > 0, else by share.
  double share = 1.0;    ///< Of the pattern's discs, relative to the other sets without spacing and P32.
  double spacing = 0.0;  ///< Mean distance along the mean normal, at most the tile's side.
  SpacingLaw spacing_law = SpacingLaw::Exponential;
  double spacing_cv = 0.5;   ///< Coefficient of variation of the lognormal law, (0, 5].
  double persistence = 1.0;  ///< Area of discs on a sheet over the sheet's; with spacing, unless the set is persistent.
  double p32 = 0.0;          ///< Area of joints in a volume, 1/m.

  RadiusLaw radius_law = RadiusLaw::Uniform;
  double radius_lo = 5.0;  ///< Bounds of every law but the persistent.
  double radius_hi = 5.0;
  double radius_exponent = 2.0;  ///< a of the power law's density ∝ r^−(a+1), (0, 20].
  double radius_mean = 5.0;      ///< Of the lognormal law before it is cut off at the bounds.
  double radius_cv = 0.5;

  /// Names of the older sets at whose joints this one's stop; kColumns: at columns.
  std::vector<std::string> ends_at{};
  double ends_share = 1.0;  ///< Share of the joints that do, the others pass.
};

/// The name by which a set ends at columns.
inline constexpr std::string_view kColumns = "columns";

/// Columns along z: Voronoi cells, 4 to 8 sides as a rule, six on average.
struct ColumnTier {
  double width = 2.4;         ///< Mean, across flats, metres: cells have the area of a hexagon as wide.
  double irregularity = 0.5;  ///< [0, 1]. 0: hexagons, as the tile allows; 1: seeds as they fell.
  double height = 1.0;        ///< Relative to the other tiers.
};

/// How joints are distributed in a tile: sets, columns, discs by hand. Lengths in metres.
struct JointPattern {
  std::vector<JointSet> sets;
  int discs = 15;                 ///< Number of discs of the sets that go by share.
  double irregular_share = 0.0;   ///< Share of those whose normals are uniform on the sphere.
  double centre_spacing = 2.0;    ///< Smallest distance between disc centres of one set, for sets by share or P32.
  std::vector<ColumnTier> columns;  ///< From the bottom up; tiers meet at joints along the bedding. None: no columns.
  std::vector<Disc> discs_at;     ///< Placed by hand: these cut before all others and keep their planes.
  /// A disc splits a block that it enters when it covers at least this share of the cut, [0, 1]: at 0 a joint grows
  /// from the least touch, at 1 it never grows beyond its disc.
  double covered_share = 0.0;
  /// The stress shadow of joints: none forms where it would part off a piece thinner than this (the diameter of its
  /// largest ball). 0: as thin as the samples can tell.
  double least_thickness = 0.0;
  double least_angle = radians(20.0);  ///< Nor where it would meet another joint at less than this angle, [0, π/3].
};

/// The tile of the paper, section 4: joint patterns are given for it.
inline constexpr double kPatternSide = 20.0;

/// The pattern that stands for a type in a tile of `side` metres; numbers and sources in block_types.cpp.
[[nodiscard]] JointPattern joint_pattern(BlockType type, double side = kPatternSide);

/// The same rock in another size: all lengths times `factor`, > 0.
[[nodiscard]] JointPattern scaled(JointPattern pattern, double factor);

/// Where the tile that joints are drawn in ends.
enum class Domain {
  Torus,  ///< Nowhere: it repeats.
  Box     ///< At walls that are no joints; joints come from beyond them.
};

/// Draws the discs of a pattern in a tile of `side` metres: older ones first, then larger ones, ties in draw order. Not
/// those of persistent sets: split_samples makes them.
///
/// By share: discs are dealt to the sets in proportion; centres of one set keep their distance where there is room for
/// it. By spacing: sheets along the mean normal, at distances by the law that add up to the torus' period there, and on
/// each as many discs as its persistence asks for. By P32: Σ π r² / side³ comes as near as discs allow. Disc i of a set
/// has a random stream of its own, so that more of a set leaves the others alone.
/// @throws ParameterError when the pattern is outside its bounds, see check_pattern.
[[nodiscard]] std::vector<Disc> draw_discs(const JointPattern& pattern, double side, Seed seed,
                                           Domain domain = Domain::Torus);

/// @throws ParameterError for a share, radius, concentration, count, spacing or termination that makes no sense.
void check_pattern(const JointPattern& pattern, double side);

/// The age of each set: 0 for those that end at none, else the greatest among the sets that it ends at, and one more.
/// @throws ParameterError for a set that ends at an unknown one, or at itself by way of others.
[[nodiscard]] std::vector<int> joint_ages(const std::vector<JointSet>& sets);

/// Sets that end at each other in a circle: "\"a\" ends at \"b\" ends at \"a\""; empty when there are none. Unknown names
/// are passed over.
[[nodiscard]] std::string termination_cycle(const std::vector<JointSet>& sets);

/// A direction (unit) along which the pattern's joints close no block, because all of them run along it to within 15°;
/// nothing when there is none.
[[nodiscard]] std::optional<Vec3> open_direction(const JointPattern& pattern);

/// The pattern with the sets of one frame turned into the tile's.
[[nodiscard]] JointPattern in_tile_frame(JointPattern pattern, JointFrame frame, const Mat3& tile_from_frame);

/// P32, the area of discs in a volume: Σ π r² / side³, in 1/m.
[[nodiscard]] double intensity(const std::vector<Disc>& discs, double side) noexcept;

/// A unit vector from the Fisher distribution about `mean`: cos θ = 1 + ln(u + (1 − u) e^(−2κ)) / κ.
[[nodiscard]] Vec3 fisher_direction(const Vec3& mean, double kappa, Rng& rng);

}  // namespace outcrop

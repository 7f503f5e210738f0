/// strata.json, version 1: the description of rock and of where it stands. Format: docs/formats.md.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "outcrop/amplify/large_fracture_rules.h"
#include "outcrop/amplify/placement_rule.h"
#include "outcrop/core/json.h"
#include "outcrop/core/vec.h"
#include "outcrop/fracture/target.h"
#include "outcrop/fracture/tile.h"
#include "outcrop/terrain/heightfield.h"
#include "outcrop/terrain/strata.h"

namespace outcrop {

/// A kind of rock.
struct RockMaterial {
  std::string name = "rock";
  BlockType block_type = BlockType::Equidimensional;
  std::optional<JointPattern> joints;  ///< Replaces the type's own pattern.
  RockTarget target;                   ///< What the tile is scaled to: see meet_targets.
  double tile_side = 0.0;              ///< Metres; 0: 20 m, or smaller on terrains too small for that.
  double sample_spacing = 0.0;         ///< Metres; 0: tile_side / kSpacingsPerSide.
  double aperture = 0.0;               ///< Metres; 0: 0.002 · tile_side.
  double rounding = 0.0;               ///< Metres; 0: 0.0125 · tile_side (25 cm at 20 m, as in the paper).
  int min_block_samples = 12;
  int variants = 8;                    ///< Of the tile, that fit side by side; 1: the tile repeats.
  std::vector<AuthoredBlock> blocks;   ///< Placed in the tile, which then has one variant.
  std::filesystem::path relief;        ///< Empty: the installed relief named "rough".
  double relief_period = 0.0;          ///< Metres; rounded so that it divides the tile's side. 0: tile_side / 5.
  double relief_amplitude = -1.0;      ///< Metres; < 0: 0.006 · tile_side.
  Vec3f colour{0.42f, 0.37f, 0.31f};   ///< Linear albedo.
  std::optional<PlacementRule> where;  ///< Where its blocks stand, beside the placement's own rule.
  std::shared_ptr<const RockMaterial> finer;  ///< Whose joints cut its blocks again; its tile is smaller. Null: none.
};

/// Where blocks stand.
struct Placement {
  double slope = radians(40.0);   ///< Ground flatter than this is left alone, radians.
  double recess = 1.0;            ///< How far the base withdraws behind the blocks, in mean block sizes, [0, 4].
  double distance_lo = -1000.0;   ///< Anchors between these distances to the surface, in mean block sizes (negative: inside).
  double distance_hi = 0.05;  ///< A little outside: a block that is missing at the top of a wall bares the ground behind it.
  double crack_depth = 0.15;      ///< Cracks are open down to this depth below the original surface, in mean block sizes.
  double lattice_azimuth = radians(27.0);  ///< The tile lattice is turned by this about the vertical, against repetition.
  std::optional<PlacementRule> where;      ///< Where rock stands, and how much; none: wherever it is steep.
  double rim = 0.0;  ///< Blocks thin out over this distance from the edge of steep ground, in mean block sizes, ≥ 0.
};

/// A geological map as the file gives it; what the terrain makes of it is Strata::map.
struct MapFile {
  std::filesystem::path image;
  std::vector<MaterialMap::Entry> entries;
  std::string place;  ///< Of the image's name in the file: `file:line:column`.
};

struct StrataFile {
  std::vector<RockMaterial> materials{RockMaterial{}};  ///< At least one.
  /// As the file gives it: `reference` and the points of faults are relative to the terrain's south-west corner, tops
  /// as the next three say. strata_on() converts.
  Strata strata;
  bool relative_tops =
      false;  ///< Elevations of the strata are relative to the terrain: 0 its lowest, 1 its highest point.
  bool thicknesses = false;  ///< Tops are metres above `base` instead.
  double base = 0.0;         ///< Elevation of the bottom of the lowest layer: of those that repeat, or of thicknesses.
  std::optional<MapFile> map;
  Placement placement;
  LargeFractureRules large_fractures;
  NodataPolicy nodata = NodataPolicy::Hole;
  Vec3f ground_colour{0.23f, 0.21f, 0.14f};             ///< Linear albedo where no rock stands.
};

/// Reads and checks a strata.json; relief paths in it are relative to the file, else names of installed reliefs.
/// @throws InputError with file, line and column.
[[nodiscard]] StrataFile read_strata(const std::filesystem::path& path);

/// The same of a file that is parsed already. @param folder  Relative relief paths start here.
/// @param default_side  The tile's side where a material names none, metres, once the terrain is known: lengths that do
/// not fit it are refused. 0: not known yet, so they are taken as they come.
[[nodiscard]] StrataFile read_strata(const Json& json, const std::filesystem::path& folder, double default_side = 0.0);

/// The strata in map coordinates and elevations of a terrain.
/// @throws InputError for a map whose image cannot be read or does not fit.
[[nodiscard]] Strata strata_on(const StrataFile& file, const Heightfield& heightfield);

/// What make_tile needs for a material, its zeros replaced by their defaults; `default_side` where it names no tile side.
[[nodiscard]] TileOptions tile_options(const RockMaterial& material, double default_side);

/// A strata file with the block types as materials, each with all of its joints: to be copied from and edited. Read back it
/// makes the types' tiles.
[[nodiscard]] std::string block_types_json();

/// How tiles lie in the world: their lattice is turned about the vertical, and then into the bedding.
[[nodiscard]] Mat3 world_from_tile(const StrataFile& file);

/// What make_tile needs for a material of the file where it lies: joint sets that were measured on the map or in its beds
/// are turned into the tile's frame.
[[nodiscard]] TileOptions tile_in_place(const StrataFile& file, std::size_t material, double default_side);
/// The same of a material that another one of the file holds.
[[nodiscard]] TileOptions tile_in_place(const StrataFile& file, const RockMaterial& material, double default_side);

/// The relief's measures with their defaults; the period divides the tile's side, so that the relief repeats with it.
struct RockRelief {
  double period = 0.0, amplitude = 0.0;  ///< Metres.
};
[[nodiscard]] RockRelief rock_relief(const RockMaterial& material, double tile_side);

/// The file with the given stem in the installed or source data folder: data/reliefs/<name>.png.
/// @throws InputError listing the known names.
[[nodiscard]] std::filesystem::path find_relief(std::string_view name);

}  // namespace outcrop

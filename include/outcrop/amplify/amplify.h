/// The whole way: terrain and strata in, amplified field out.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "outcrop/amplify/strata_file.h"
#include "outcrop/core/task.h"
#include "outcrop/fracture/tile_figure.h"
#include "outcrop/implicit/field.h"
#include "outcrop/terrain/heightfield.h"

namespace outcrop {

struct AmplifyOptions {
  Vec2 region_lo{0.0}, region_hi{0.0};  ///< Map coordinates; the rectangle that is wanted.
  double resolution = 0.25;             ///< Metres: detail below two of these is left out.
  Seed seed = 1;
  bool measure = false;                 ///< Whether tiles are measured and classified, for reports.
};

/// What one material contributed.
struct RockReport {
  std::string material;
  BlockType type = BlockType::Equidimensional;
  TileStatistics tile;
  std::optional<TileReport> measured;      ///< When asked for.
  std::vector<double> block_volumes;       ///< Of the tile's blocks, m³.
  std::vector<std::size_t> block_faces;
  std::vector<Vec3> block_sizes;           ///< Extents along the tile's axes, metres.
  std::size_t tile_blocks = 0;
  std::size_t replicated_blocks = 0;       ///< Present in the region.
  std::size_t finer_blocks = 0;            ///< That cut them again; 0: none, or too small for the resolution.
  std::size_t bytes = 0;                   ///< Memory of the tile's field functions.
};

struct Amplified {
  FieldPtr field;                          ///< The amplified terrain, world (map) coordinates.
  FieldPtr ground;                         ///< The same without holes where data are missing.
  FieldPtr hole;                           ///< > 0 where data are missing and holes are wanted, else null.
  FieldPtr terrain;                        ///< The terrain as it came, holes filled.
  Box region;                              ///< Wanted rectangle with the heights that the surface can take, and a floor.
  std::vector<std::string> label_names;    ///< Label → name: the materials in order, then "ground".
  std::vector<Vec3f> label_colours;
  std::vector<RockReport> rocks;
  double rock_coverage = 0.0;  ///< Share of the input's steep surface that is blocks, sampled.
  double mean_offset = 0.0;                ///< Mean signed distance of rock from the input surface, metres (sampled).
  double mean_block_size = 0.0;            ///< Cube root of the mean block volume, metres; largest over materials.
  double tile_seconds = 0.0, placement_seconds = 0.0;
};

/// Composes the amplified terrain: clip ∩ (recessed base ∪ replicated blocks), design decisions 8 to 10.
///
/// Below the slope threshold the field equals the terrain's to the bit. Same input, options and seed: the same field.
/// @throws ParameterError for a region outside the terrain; Cancelled.
[[nodiscard]] Amplified amplify(const Heightfield& heightfield, const StrataFile& strata, const AmplifyOptions& options,
                                const Task& task = {});

/// The square window of about `size` metres whose ground is steepest, map coordinates: what amplify frames by default.
struct SteepWindow {
  Vec2 lo, hi;
  Vec3 focus;      ///< A point on the steep surface, in its middle.
  Vec2 downhill;   ///< Unit; mean direction in which the steep ground falls.
  double share;    ///< Of the window steeper than the threshold.
};
[[nodiscard]] SteepWindow steepest_window(const Heightfield& heightfield, double size, double slope);

/// The tile side that suits a terrain when nobody asks: 20 m, or a quarter of the terrain's shorter extent if that is less.
[[nodiscard]] double default_tile_side(const Heightfield& heightfield);

}  // namespace outcrop

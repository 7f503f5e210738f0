/// The main job from files to files: what the program `amplify` does once its command line is read.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "outcrop/amplify/amplify.h"
#include "outcrop/core/task.h"
#include "outcrop/terrain/read_heightfield.h"

namespace outcrop {

struct AmplifyRun {
  std::filesystem::path heightmap;                ///< Empty: tile reports alone.
  std::filesystem::path strata;                   ///< Empty: built-in defaults.
  std::vector<std::filesystem::path> meshes;      ///< .ply, .obj, .stl, .vdb
  std::vector<std::filesystem::path> previews;    ///< .png, .exr
  std::filesystem::path report;                   ///< Empty: none.
  std::vector<std::filesystem::path> tile_reports; ///< .html, .json: pages and numbers on the materials' tiles.
  HeightfieldOptions heights;
  Interpolation interpolation = Interpolation::Smooth;
  std::optional<NodataPolicy> nodata;             ///< Overrides the strata file.
  /// x0, y0, x1, y1: map coordinates where the heightmap is georeferenced, else metres from its south-west corner.
  std::optional<std::array<double, 4>> region;
  std::optional<double> resolution;               ///< Metres.
  std::optional<double> tolerance;                ///< Metres off the surface where cells are not finest; 0: all are. Missing:
                                                  ///< a tenth of the resolution where less than half of the ground is steep, else 0.
  std::size_t triangles = 0;                      ///< About as many as are wanted; 0: as it comes.
  bool crisp = false;                             ///< Vertices on creases.
  bool solid = false;                             ///< Walls and a floor.
  Seed seed = 1;
  int threads = 0;                                ///< 0: all cores.
  double memory_limit_gib = 0.0;                  ///< 0: half of the machine's memory.
  bool dry_run = false;
  int width = 1280, height = 720;                 ///< Of previews, pixels.
  /// Position and target, metres from the terrain's south-west corner as in meshes; missing: frames the steepest part.
  std::optional<std::array<double, 6>> camera;
  double fov_deg = 40.0;                          ///< Vertical.
  std::string command;                            ///< For the report.
};

/// Takes one line that people should see: an assumption, a choice, a file written.
using Notify = std::function<void(const std::string& line)>;

/// Reads, amplifies, meshes, renders and writes. Without any output and without dry_run: `<heightmap's stem>_rock.ply` and
/// `.png` in the working folder.
///
/// @return what belongs on stdout: the expectations of a dry run, else nothing.
/// @throws InputError, ParameterError, SystemError, Cancelled; outputs appear whole or not at all.
[[nodiscard]] std::string run_amplify(AmplifyRun run, const Notify& notify = {}, const Task& task = {});

/// The rectangle (map coordinates) and the cell that are meshed when the caller leaves one or both open.
struct Window {
  Vec2 lo{0.0}, hi{0.0};
  double resolution = 0.25;
  std::string note{};  ///< One line when something was chosen that the caller may want otherwise.
};

/// A given region and resolution are kept. Else cells are a twelfth of a mean block. A terrain that would need more than
/// some 4 million triangles so is cut to its steepest square; a region that would need more than 8 million gets wider cells.
/// @throws ParameterError for a region that is not inside the terrain, naming the terrain's rectangle.
[[nodiscard]] Window choose_window(const Heightfield& heightfield, const StrataFile& strata, const AmplifyRun& run);

}  // namespace outcrop

/// What a run of amplify did, for people and for scripts. Format: docs/formats.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "outcrop/amplify/amplify.h"
#include "outcrop/mesh/mesh_measure.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/render/preview.h"

namespace outcrop {

/// "0.1.0"
[[nodiscard]] std::string_view version() noexcept;

/// The largest resident size of this process so far, bytes.
[[nodiscard]] std::size_t peak_memory();

struct StageSeconds {
  double reading = 0.0, tiles = 0.0, placement = 0.0, meshing = 0.0, writing = 0.0, preview = 0.0, total = 0.0;
};

struct AmplifyReport {
  std::string command;                     ///< As it was called.
  std::filesystem::path heightmap;
  std::filesystem::path strata;            ///< Empty: built-in defaults.
  std::vector<std::string> notes;          ///< What had to be assumed or chosen.
  std::optional<Heightfield> heightfield;
  StrataFile rock;
  AmplifyOptions options;                  ///< Region, resolution, seed.
  Vec3 origin{0.0};                        ///< What positions of meshes are relative to, map coordinates and elevation.
  Interpolation interpolation = Interpolation::Smooth;
  bool solid = false;
  int threads = 1;
  std::size_t memory_limit = 0;            ///< Bytes.
  Amplified amplified;
  std::optional<PolygonizeStatistics> polygonized;
  std::optional<MeshMeasure> mesh;
  std::optional<PreviewStatistics> preview;
  StageSeconds seconds;
  std::vector<std::filesystem::path> outputs;
};

/// The report as JSON text: lengths in metres, memory in bytes, times in seconds.
[[nodiscard]] std::string report_json(const AmplifyReport& report);

}  // namespace outcrop

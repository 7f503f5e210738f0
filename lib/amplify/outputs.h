/// What both programs do with their outputs: check them before long work, write them after it.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "outcrop/amplify/report.h"

namespace outcrop {

inline constexpr double kVdbBand = 3.0;               ///< Voxels of a level set on either side of the surface.
inline constexpr double kLevelSetBytesACell = 250.0;  ///< Of memory, a cell of the surface; 232 to 267 measured.

inline constexpr double kLeastLength = 1e-6;  ///< Metres: of cells and solids. Far below, floats run out of exponents.

/// Where a run wants to write.
struct Outputs {
  std::vector<std::filesystem::path> meshes;    ///< .ply, .obj, .stl, .vdb
  std::vector<std::filesystem::path> previews;  ///< .png, .exr
  std::filesystem::path report;                 ///< Any name; may be empty.
  std::vector<std::filesystem::path> tile_reports{};  ///< .html, .json

  [[nodiscard]] std::vector<std::filesystem::path> all() const;
};

/// @throws ParameterError for an unknown extension, a folder that cannot be written to, a file named twice or an input.
void check_outputs(const Outputs& outputs, const std::vector<std::filesystem::path>& inputs);

/// @throws ParameterError for a picture of less than 16 or more than 16384 pixels a side.
void check_size(int width, int height);

[[nodiscard]] bool is_vdb(const std::filesystem::path& path);
/// Whether any of the outputs needs triangles.
[[nodiscard]] bool wants_triangles(const Outputs& outputs);

/// Whether any of the outputs is a level set.
[[nodiscard]] bool wants_level_set(const Outputs& outputs);

/// Writes .png (beauty) or .exr (all layers).
void write_preview(const std::filesystem::path& path, const Preview& preview);

/// Writes the solid that a closed mesh bounds as a narrow-band level set, `.vdb`, in the mesh's own coordinates.
void write_level_set(const std::filesystem::path& path, const TriangleMesh& mesh, double voxel, const Task& task);

/// Cells between a mesh's origin and its farthest point, so that a float's rounding stays within a thousandth of a cell.
inline constexpr double kExactCells = 1 << 15;

/// Half of the machine's memory, or `gib` when that is > 0; bytes. @throws ParameterError for anything else.
[[nodiscard]] std::size_t memory_limit_bytes(double gib);

/// "1.5 GiB", "340 kB"-like, in powers of 1000 with three digits.
[[nodiscard]] std::string byte_text(double bytes);
/// A number with at most `digits` significant digits.
[[nodiscard]] std::string number_text(double value, int digits = 4);
/// "1 234 567"
[[nodiscard]] std::string count_text(double value);

/// Wall-clock seconds since it was made or last asked.
class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> passed = now - last_;
    last_ = now;
    return passed.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace outcrop

/// Scenes for polygonize: a tree of fields in JSON. Format: data/schemas/scene.schema.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "outcrop/core/task.h"
#include "outcrop/implicit/field.h"

namespace outcrop {

/// What a scene file says.
struct Scene {
  FieldPtr field;
  std::optional<Box> region;               ///< Named by the file, else where the field's support is known, a little grown.
  std::optional<double> resolution;        ///< Metres, when the file names one.
  std::vector<std::string> label_names;    ///< Label → name, in the order of "materials"; at least one.
  std::vector<Vec3f> label_colours;        ///< Linear albedo, one a name.
  std::vector<std::string> notes;          ///< What had to be assumed about the files that it names, one line each.
};

/// Reads `{"version": 1, "field": {<kind>: {…}}, "region": …, "resolution": …, "materials": […]}`.
///
/// Files named inside are relative to the scene's folder.
/// @throws InputError with file, line and column; Cancelled.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path, const Task& task = {});

inline constexpr double kDefaultCells = 128;  ///< Cells along the longest side where nobody names a resolution.

/// A mesh as a field.
struct MeshField {
  FieldPtr field;
  std::string note;  ///< One line where the mesh is open, else empty.
};

/// The signed distance to the closed mesh in a .ply, .obj or .stl file; voxel 0: its longest side / 128.
///
/// Inside is what cannot be reached from outside, so gaps narrower than a voxel do no harm; vertices at one place count
/// as one, and it does not matter which way triangles turn.
/// @throws InputError also for an open mesh that encloses nothing.
[[nodiscard]] MeshField mesh_field(const std::filesystem::path& path, double voxel = 0.0, const Task& task = {});

/// The region in which a field is meshed when nobody names one: its support, or else the box that its bounds leave
/// within 16 km of the origin, grown by 2 %. Nothing for solids without end.
[[nodiscard]] std::optional<Box> default_region(const Field& field);

}  // namespace outcrop

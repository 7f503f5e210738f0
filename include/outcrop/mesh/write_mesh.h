/// Mesh writers: .ply (binary), .obj, .stl (binary); each atomic (core/file.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "outcrop/core/task.h"
#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop {

struct MeshMetadata {
  std::vector<std::string> comments;        ///< Lines for the file's header: map origin, command, seed.
  std::vector<std::string> material_names;  ///< For labels.
  std::vector<Vec3f> material_colours;      ///< Linear RGB, one a material; may be empty.
};

/// Chooses the format by the extension. Positions are written relative to mesh.origin.
/// @throws ParameterError naming the known extensions; SystemError.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh, const MeshMetadata& metadata = {},
                const Task& task = {});

/// Reads .ply (binary or text), .obj and .stl triangles (polygons are fanned); for polygonize's mesh input.
/// @throws InputError.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace outcrop

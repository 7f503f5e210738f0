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
///
/// .ply: float x y z, nx ny nz, uchar red green blue (sRGB; when there are colours) and uchar material (ushort past
/// 255), faces of uint. .obj: v, vn, and usemtl by the label that most corners of a face have. .stl: positions alone.
/// @throws ParameterError naming the known extensions; SystemError; Cancelled.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh, const MeshMetadata& metadata = {},
                const Task& task = {});

/// Reads .ply and .stl (binary or text) and .obj; polygons are fanned, normals and materials come from .ply alone.
///
/// Corners of .stl triangles are welded where their coordinates are equal. A mesh far from its file's origin, as in map
/// coordinates, gets an origin of its own; else mesh.origin is 0.
/// @throws InputError naming the line of a text, the element of a binary file.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace outcrop

/// Mesh writers: .ply (binary), .obj, .stl (binary); each atomic (core/file.h).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "outcrop/core/task.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop {

struct MeshMetadata {
  std::vector<std::string> comments;        ///< Lines for the file's header: map origin, command, seed.
  std::vector<std::string> material_names;  ///< For labels.
  std::vector<Vec3f> material_colours;      ///< Linear RGB, one a material; may be empty.
  std::optional<Vec3> origin;               ///< What positions are written relative to; else the mesh's own origin.
};

/// Writes a mesh as it comes, in memory that does not grow with it; the file appears with end().
///
/// Chooses the format by the extension. .ply: float x y z, nx ny nz, uchar red green blue (sRGB; when there are colours)
/// and uchar material (ushort past 255), faces of uint. .obj: v, vn, and usemtl by the label that most corners of a face
/// have. .stl: positions alone. What stands later in the file than it comes waits in files beside it, gone with the
/// writer.
/// @throws ParameterError naming the known extensions; its members throw SystemError and Cancelled.
[[nodiscard]] std::unique_ptr<MeshSink> mesh_writer(const std::filesystem::path& path, MeshMetadata metadata = {},
                                                    const Task& task = {});

/// The same bytes, from a mesh that is all there.
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

/// Voxel grids as Fields: OpenVDB level sets in and out, closed meshes turned into distance.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

#include "outcrop/core/task.h"
#include "outcrop/implicit/field.h"

namespace outcrop {

/// The first float grid of a `.vdb` file (or the one named), as a level set: trilinear, negative inside.
/// @throws InputError when the file is no VDB, holds no float grid or an empty one.
[[nodiscard]] FieldPtr read_vdb(const std::filesystem::path& path, const Task& task = {});

/// The signed distance to a closed triangle mesh, sampled at `voxel` metres in a band of `half_width` voxels.
/// @throws ParameterError for a voxel ≤ 0 or an empty mesh.
[[nodiscard]] FieldPtr mesh_distance(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
                                     double voxel, double half_width = 4.0, const Task& task = {});

/// Writes the field's zero surface in `region` as a narrow-band level set (FloatGrid "surface"), atomically.
/// Values are clamped to ± half_width · voxel; only bricks that `bound` cannot exclude are evaluated.
void write_vdb(const std::filesystem::path& path, const Field& field, const Box& region, double voxel,
               const Vec3& origin, double half_width = 3.0, const Task& task = {});

}  // namespace outcrop

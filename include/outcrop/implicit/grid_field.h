/// Voxel grids as Fields: OpenVDB level sets in and out, closed meshes turned into distance.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

#include "outcrop/core/task.h"
#include "outcrop/implicit/field.h"

namespace outcrop {

/// The first float grid of a `.vdb` file as a level set: trilinear, negative inside, and its constant background
/// outside of what it stores. The Lipschitz constant comes from the stored values, bounds from a pyramid of their
/// ranges.
/// @throws InputError when the file is missing, no VDB, truncated, holds no float grid, or one that is empty, not
/// finite, or
///         mapped to the world by more than an affine transform.
[[nodiscard]] FieldPtr read_vdb(const std::filesystem::path& path, const Task& task = {});

/// The signed distance to a closed triangle mesh, sampled at `voxel` metres in a band of `half_width` voxels (≥ 1) and
/// constant beyond it. Which way the triangles turn does not matter: inside is what cannot be reached from outside.
/// @throws ParameterError for a voxel ≤ 0 or a mesh that is empty, not finite or refers to vertices that it lacks.
[[nodiscard]] FieldPtr mesh_distance(std::span<const Vec3> vertices,
                                     std::span<const std::array<std::uint32_t, 3>> triangles, double voxel,
                                     double half_width = 4.0, const Task& task = {});

/// Writes the field's solid inside `region` as a narrow-band level set (FloatGrid "surface"), atomically and with the
/// same bytes for any number of threads. The region's border closes the solid.
///
/// Values are clamped to ± half_width · voxel; only bricks that `bound` cannot exclude are evaluated.
/// @param origin  World position of the file's (0, 0, 0): file coordinates are world − origin.
/// @throws ParameterError for a voxel ≤ 0, a half_width < 1, an empty region or a path that cannot be written;
/// SystemError
///         when the disk refuses; Cancelled.
void write_vdb(const std::filesystem::path& path, const Field& field, const Box& region, double voxel,
               const Vec3& origin, double half_width = 3.0, const Task& task = {});

}  // namespace outcrop

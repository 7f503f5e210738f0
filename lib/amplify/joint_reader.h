/// The keys of a material that say how its joints run.
#pragma once

#include <filesystem>
#include <optional>

#include "outcrop/core/json.h"
#include "outcrop/fracture/joints.h"

namespace outcrop {

/// The type's pattern with what the file says instead; nothing when it says nothing.
///
/// @param folder  Relative paths of measured orientations start here.
/// @param side, spacing  Of the tile and of its samples, metres.
[[nodiscard]] std::optional<JointPattern> read_joints(JsonReader& reader, BlockType type,
                                                      const std::filesystem::path& folder, double side,
                                                      double spacing);

/// Whether a length of the joints stands in metres: then the tile cannot be scaled to suit the terrain.
[[nodiscard]] bool has_joint_lengths(JsonReader& reader);

}  // namespace outcrop

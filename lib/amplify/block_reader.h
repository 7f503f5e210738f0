/// Authored blocks in a material.
#pragma once

#include <filesystem>
#include <vector>

#include "outcrop/core/json.h"
#include "outcrop/fracture/authored_blocks.h"

namespace outcrop {

/// The key "blocks"; meshes are relative to `folder`. @param side  Of the tile, metres; 0: not known yet.
/// @throws InputError also for meshes that are open or not convex, and for blocks that overlap or are too long.
[[nodiscard]] std::vector<AuthoredBlock> read_blocks(JsonReader& reader, const std::filesystem::path& folder,
                                                     double side);

}  // namespace outcrop

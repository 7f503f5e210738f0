/// The keys of one rock material, shared by strata.json and the tiles of scenes.
#pragma once

#include <filesystem>

#include "outcrop/amplify/strata_file.h"
#include "outcrop/core/json.h"

namespace outcrop {

inline constexpr Bounds kPositive{.lo = 0.0, .open_lo = true};

/// Reads a material's keys; the caller calls `finish()`. What it accepts makes a tile.
///
/// @param folder  Relative relief paths start here.
/// @param default_side  Of the tile where the material names none, metres; 0: not known yet, so lengths are taken as
/// they come.
[[nodiscard]] RockMaterial read_material(JsonReader& reader, const std::filesystem::path& folder, double default_side);

/// 0, which stands for a default or for none, or a number within bounds.
[[nodiscard]] double zero_or_number(JsonReader& reader, std::string_view key, const Bounds& bounds);

/// The image that a "relief" key means: the name of an installed relief, or a path relative to `folder`.
[[nodiscard]] std::filesystem::path resolve_relief(const Json& image, const std::filesystem::path& folder);

}  // namespace outcrop

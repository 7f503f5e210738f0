/// Placement rules in strata.json.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "outcrop/amplify/placement_rule.h"
#include "outcrop/core/json.h"

namespace outcrop {

/// @param materials  Names of the file's materials, by label.  @param folder  Relative image paths start here.
/// @throws InputError with the place of what is wrong.
[[nodiscard]] PlacementRule read_rule(const Json& json, const std::vector<std::string_view>& materials,
                                      const std::filesystem::path& folder);

/// The image file that a key names, relative to `folder`. @throws InputError when there is no such file.
[[nodiscard]] std::filesystem::path image_path(const Json& json, const std::filesystem::path& folder);

}  // namespace outcrop

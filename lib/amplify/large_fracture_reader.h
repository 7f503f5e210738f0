/// The key "large_fractures" of strata.json.
#pragma once

#include "outcrop/amplify/large_fracture_rules.h"
#include "outcrop/core/json.h"

namespace outcrop {

/// @throws InputError with file, line and column.
[[nodiscard]] LargeFractureRules read_large_fractures(const Json& json);

}  // namespace outcrop

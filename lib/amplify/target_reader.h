/// The "target" key of a material.
#pragma once

#include "outcrop/core/json.h"
#include "outcrop/fracture/target.h"

namespace outcrop {

/// Reads `"target": {"block_volume": m³, "jv": 1/m, "rqd": percent}`; empty without the key.
/// @throws InputError for an object without any of these, or values out of their bounds.
[[nodiscard]] RockTarget read_target(JsonReader& reader);

}  // namespace outcrop

/// Where the files that come with the project are: reliefs, example strata, schemas.
#pragma once

#include <filesystem>

namespace outcrop {

/// The folder that holds `reliefs/`, `strata/` and `schemas/`.
///
/// Looked for in this order: the environment variable OUTCROP_DATA, `../share/outcrop` beside the running program, the
/// `data` folder of the source tree, the folder of the configured install prefix.
/// @throws InputError when there is none, or OUTCROP_DATA names no folder.
[[nodiscard]] std::filesystem::path data_path();

}  // namespace outcrop

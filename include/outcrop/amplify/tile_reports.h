/// Targets of materials, and reports on their tiles: rock in numbers, with or without a terrain.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "outcrop/amplify/strata_file.h"
#include "outcrop/core/task.h"

namespace outcrop {

/// Materials whose targets have become lengths.
struct SizedStrata {
  StrataFile file;
  std::vector<std::string> notes;  ///< One line a material with a target: what it reaches.
};

/// Finds the tile sides (and with them all other lengths) of the materials that ask for a block volume, Jv or RQD, as
/// their tiles lie; others stay as they are. @param seed  Of the first material; the next ones count on.
/// Cost: a tile a material with a target.
[[nodiscard]] SizedStrata meet_targets(StrataFile file, double default_side, Seed seed, const Task& task = {});

/// Writes a report on every material's tile: one page each in a `.html`, all numbers in a `.json`.
/// @param default_side  Of tiles whose material names none, metres.
/// @throws SystemError, Cancelled. Cost: a tile a material.
void write_tile_reports(const std::vector<std::filesystem::path>& paths, const StrataFile& file, double default_side,
                        Seed seed, const std::string& title, const Task& task = {});

}  // namespace outcrop

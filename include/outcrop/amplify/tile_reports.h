/// Targets of materials, and reports on their tiles: rock in numbers, with or without a terrain.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "outcrop/amplify/strata_file.h"
#include "outcrop/core/task.h"

namespace outcrop {

/// A material whose target has become lengths.
struct SizedMaterial {
  RockMaterial material;
  std::string note;  ///< One line: what is reached. Empty without a target.
};

/// Finds the tile side (and with it all other lengths) of a material that asks for a block volume, Jv or RQD; others
/// stay as they are. Cost: a tile where there is a target.
/// @param file  How its tiles lie: those of the materials that stand in it.
[[nodiscard]] SizedMaterial meet_target(RockMaterial material, const StrataFile& file, double default_side, Seed seed,
                                        const Task& task = {});

/// Materials whose targets have become lengths.
struct SizedStrata {
  StrataFile file;
  std::vector<std::string> notes;  ///< One line a material with a target: what it reaches.
};

/// The same for all materials of a file. @param seed  Of the first material; the next ones count on.
[[nodiscard]] SizedStrata meet_targets(StrataFile file, double default_side, Seed seed, const Task& task = {});

/// Writes a report on every material's tile: one page each in a `.html`, all numbers in a `.json`.
/// @param default_side  Of tiles whose material names none, metres.
/// @throws SystemError, Cancelled. Cost: a tile a material.
void write_tile_reports(const std::vector<std::filesystem::path>& paths, const StrataFile& file, double default_side,
                        Seed seed, const std::string& title, const Task& task = {});

}  // namespace outcrop

#include "outcrop/amplify/tile_reports.h"

#include <utility>

#include "outcrop/core/file.h"
#include "outcrop/core/json.h"
#include "outcrop/fracture/target.h"
#include "outcrop/fracture/tile_figure.h"

namespace outcrop {

SizedStrata meet_targets(StrataFile file, double default_side, Seed seed, const Task& task) {
  SizedStrata result{.file = std::move(file)};
  for (std::size_t m = 0; m < result.file.materials.size(); ++m) {
    RockMaterial& material = result.file.materials[m];
    if (!material.target.any()) continue;
    const TargetedTile fitted = fit_tile(tile_in_place(result.file, m, default_side), material.target, seed + m, task);
    if (material.joints) material.joints = scaled(tile_options(material, default_side), fitted.scale).pattern;
    material.tile_side = fitted.options.side;
    // What stands at its default (0) follows the side by itself.
    if (material.sample_spacing > 0.0) material.sample_spacing = fitted.options.spacing;
    if (material.aperture > 0.0) material.aperture = fitted.options.aperture;
    if (material.rounding > 0.0) material.rounding = fitted.options.rounding;
    result.notes.push_back("material \"" + material.name + "\": " + fitted.note);
  }
  return result;
}

void write_tile_reports(const std::vector<std::filesystem::path>& paths, const StrataFile& file, double default_side,
                        Seed seed, const std::string& title, const Task& task) {
  std::vector<std::string> pages;
  JsonWriter json;
  json.begin_object().begin_array("rocks");
  for (std::size_t m = 0; m < file.materials.size(); ++m) {
    const RockMaterial& material = file.materials[m];
    TileOptions options = tile_in_place(file, m, default_side);
    options.blocks.clear();  // The report is on the rock, not on what was placed in it.
    const Tile tile = make_tile(options, seed + m, task);
    const std::string asked =
        "Asked for: " + std::string(name(material.block_type)) + (material.joints ? ", joint sets of its own" : "") +
        (material.target.any() ? ", " + described(material.target) : "") + "; seed " + std::to_string(seed + m);
    const TileReport report = tile_report(tile, material.name, {asked}, world_from_tile(file), task);
    pages.push_back(tile_figure_svg(tile, report));
    json.begin_object();
    write_tile_report(json, report);
    json.end_object();
  }
  const std::string numbers = json.end_array().end_object().text();
  for (const std::filesystem::path& path : paths) {
    OutputFile output(path);
    output.write(path.extension() == ".json" ? numbers : tile_figure_html(pages, title));
    output.commit();
  }
}

}  // namespace outcrop

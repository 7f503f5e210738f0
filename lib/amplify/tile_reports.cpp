#include "outcrop/amplify/tile_reports.h"

#include <utility>

#include "lie.h"
#include "outcrop/core/file.h"
#include "outcrop/core/json.h"
#include "outcrop/fracture/target.h"
#include "outcrop/fracture/tile_figure.h"

namespace outcrop {

SizedMaterial meet_target(RockMaterial material, const StrataFile& file, double default_side, Seed seed,
                          const Task& task) {
  if (!material.target.any()) return {std::move(material), {}};
  const TargetedTile fitted = fit_tile(tile_options(material, default_side, lie_of(file)), material.target, seed, task);
  if (material.joints) material.joints = scaled(tile_options(material, default_side), fitted.scale).pattern;
  material.tile_side = fitted.options.side;
  // What stands at its default (0) follows the side by itself.
  if (material.sample_spacing > 0.0) material.sample_spacing = fitted.options.spacing;
  if (material.aperture > 0.0) material.aperture = fitted.options.aperture;
  if (material.rounding > 0.0) material.rounding = fitted.options.rounding;
  std::string note = "material \"" + material.name + "\": " + fitted.note;
  return {std::move(material), std::move(note)};
}

SizedStrata meet_targets(StrataFile file, double default_side, Seed seed, const Task& task) {
  SizedStrata result{.file = std::move(file)};
  for (std::size_t m = 0; m < result.file.materials.size(); ++m) {
    SizedMaterial sized = meet_target(result.file.materials[m], result.file, default_side, seed + m, task);
    result.file.materials[m] = std::move(sized.material);
    if (!sized.note.empty()) result.notes.push_back(std::move(sized.note));
  }
  return result;
}

void write_tile_reports(const std::vector<std::filesystem::path>& paths, const StrataFile& file, double default_side,
                        Seed seed, const std::string& title, const Task& task) {
  std::vector<std::string> pages;
  const Lie lie = lie_of(file);
  JsonWriter json;
  json.begin_object().begin_array("rocks");
  for (std::size_t m = 0; m < file.materials.size(); ++m) {
    const RockMaterial& material = file.materials[m];
    const Tile tile = make_tile(tile_options(material, default_side, lie), seed + m, task);
    const std::string asked =
        "Asked for: " + std::string(name(material.block_type)) + (material.joints ? ", joint sets of its own" : "") +
        (material.target.any() ? ", " + described(material.target) : "") + "; seed " + std::to_string(seed + m);
    const TileReport report = tile_report(tile, material.name, {asked}, lie.world_from_tile(), task);
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

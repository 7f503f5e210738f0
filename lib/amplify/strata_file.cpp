#include "outcrop/amplify/strata_file.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "material_reader.h"

namespace outcrop {
namespace {

constexpr int kVersion = 1;

std::vector<RockMaterial> read_materials(JsonReader& reader, const std::filesystem::path& folder,
                                         double default_side) {
  const Json* json = reader.child("materials");
  if (!json) return {RockMaterial{}};
  const std::vector<Json>& items = reader.array("materials");
  if (items.empty()) json->fail("\"materials\": at least one material", "none");
  std::vector<RockMaterial> materials;
  for (const Json& item : items) {
    JsonReader material(item);
    RockMaterial read = read_material(material, folder, default_side);
    material.finish();
    for (const RockMaterial& other : materials)
      if (other.name == read.name) item.fail("a material with a name of its own", "\"" + read.name + "\" for the second time");
    materials.push_back(std::move(read));
  }
  return materials;
}

Stratum read_layer(const Json& json, const std::vector<std::string_view>& names, bool last, bool relative) {
  JsonReader reader(json);
  Stratum layer;
  if (!reader.has("material")) json.fail("a layer with the key \"material\"", "one without");
  layer.material = static_cast<Label>(reader.choice("material", 0, names));
  if (!last && !reader.has("top")) json.fail("a layer with the key \"top\"", "one without; only the last may lack it");
  const Bounds bounds = relative ? Bounds{-10.0, 10.0} : Bounds{-12'000.0, 12'000.0};
  layer.top = reader.has("top") ? reader.number("top", 0.0, bounds) : std::numeric_limits<double>::infinity();
  reader.finish();
  return layer;
}

void read_strata_pile(const Json& json, StrataFile& file) {
  JsonReader reader(json);
  Strata& strata = file.strata;
  file.relative_tops = reader.choice("tops", 0, {"elevation", "relative"}) == 1;
  std::vector<std::string_view> names;
  for (const RockMaterial& material : file.materials) names.push_back(material.name);
  const std::vector<Json>& layers = reader.array("layers");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    strata.layers.push_back(read_layer(layers[i], names, i + 1 == layers.size(), file.relative_tops));
    if (i > 0 && !(strata.layers[i].top > strata.layers[i - 1].top)) {
      JsonReader layer(layers[i]);
      layer.child("top")->fail("a \"top\" above that of the layer below; layers go from bottom to top");
    }
  }
  strata.dip = radians(reader.number("dip_deg", 0.0, {0.0, 60.0}));
  strata.dip_direction = radians(reader.number("dip_direction_deg", 0.0, {0.0, 360.0}));
  strata.undulation = reader.number("undulation", strata.undulation, {0.0, 1000.0});
  if (reader.has("undulation_wavelength"))
    strata.undulation_wavelength = reader.number("undulation_wavelength", strata.undulation_wavelength, kPositive);
  const std::vector<double> reference = reader.numbers("reference", {0.0, 0.0}, 2);
  strata.reference = {reference[0], reference[1]};
  reader.finish();
}

Placement read_placement(const Json& json) {
  JsonReader reader(json);
  Placement placement;
  placement.slope = radians(reader.number("slope_deg", degrees(placement.slope), {0.0, 89.0}));
  placement.recess = reader.number("recess", placement.recess, {0.0, 4.0});
  const std::vector<double> distance =
      reader.numbers("distance", {placement.distance_lo, placement.distance_hi}, 2, {-100.0, 100.0});
  if (!(distance[0] < distance[1])) reader.child("distance")->fail("\"distance\": the lower end before the upper");
  placement.distance_lo = distance[0];
  placement.distance_hi = distance[1];
  placement.crack_depth = reader.number("crack_depth", placement.crack_depth, {0.0, 1000.0});
  placement.lattice_azimuth =
      radians(reader.number("lattice_azimuth_deg", degrees(placement.lattice_azimuth), {-360.0, 360.0}));
  reader.finish();
  return placement;
}

Mat3 bedding_from_tile(const Placement& placement) {
  const double c = std::cos(placement.lattice_azimuth);
  const double s = std::sin(placement.lattice_azimuth);
  return {Vec3(c, s, 0.0), Vec3(-s, c, 0.0), Vec3(0.0, 0.0, 1.0)};
}

}  // namespace

Mat3 world_from_tile(const StrataFile& file) {
  return file.strata.world_from_bedding() * bedding_from_tile(file.placement);
}

TileOptions tile_in_place(const StrataFile& file, std::size_t material, double default_side) {
  TileOptions options = tile_options(file.materials[material], default_side);
  const Mat3 tile_from_bedding = glm::transpose(bedding_from_tile(file.placement));
  options.pattern = in_tile_frame(std::move(options.pattern), JointFrame::Bedding, tile_from_bedding);
  options.pattern = in_tile_frame(std::move(options.pattern), JointFrame::Map, glm::transpose(world_from_tile(file)));
  return options;
}

StrataFile read_strata(const std::filesystem::path& path) { return read_strata(read_json(path), path.parent_path()); }

StrataFile read_strata(const Json& json, const std::filesystem::path& folder, double default_side) {
  JsonReader reader(json);
  StrataFile file;
  (void)reader.string("$schema", "");
  (void)reader.string("description", "");
  (void)reader.integer("version", kVersion, kVersion, kVersion);
  file.materials = read_materials(reader, folder, default_side);
  if (const Json* strata = reader.child("strata")) read_strata_pile(*strata, file);
  if (const Json* placement = reader.child("placement")) file.placement = read_placement(*placement);
  const Vec3f& ground = file.ground_colour;
  const std::vector<double> colour = reader.numbers("ground_colour", {ground.r, ground.g, ground.b}, 3, {0.0, 1.0});
  if (reader.has("ground_colour")) file.ground_colour = Vec3f(colour[0], colour[1], colour[2]);
  file.nodata = reader.choice("nodata", 0, {"hole", "fill"}) == 1 ? NodataPolicy::Fill : NodataPolicy::Hole;
  reader.finish();
  return file;
}

}  // namespace outcrop

#include "outcrop/amplify/strata_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "large_fracture_reader.h"
#include "material_reader.h"
#include "outcrop/core/error.h"
#include "rule_reader.h"

namespace outcrop {
namespace {

constexpr int kVersion = 1;
constexpr Bounds kThickness{0.001, 12'000.0};  // Metres, of layers.
constexpr std::size_t kMostLayers = 10'000;
constexpr std::size_t kMostFaults = 32;
constexpr double kSteepestFold = 0.25;  // Amplitude over wavelength: limbs of 57 degrees.

std::vector<std::string_view> names_of(const std::vector<RockMaterial>& materials) {
  std::vector<std::string_view> names;
  for (const RockMaterial& material : materials) names.push_back(material.name);
  return names;
}

/// Joints, reliefs and lengths of a material, and no more.
std::shared_ptr<const RockMaterial> read_finer(const Json& json, const RockMaterial& coarse,
                                               const std::filesystem::path& folder, double default_side) {
  JsonReader reader(json);
  for (const char* key : {"name", "colour", "target"})
    if (reader.has(key)) reader.child(key)->fail("\"finer\" without \"" + std::string(key) + "\"", "one with it");
  if (!reader.has("tile_side")) json.fail("\"finer\" with the key \"tile_side\"", "one without");
  RockMaterial finer = read_material(reader, folder, default_side);
  const double side = coarse.tile_side > 0.0 ? coarse.tile_side : default_side;
  if (side > 0.0 && !(finer.tile_side < side))
    reader.child("tile_side")->fail("\"tile_side\": less than the material's own, " + std::to_string(side) + " m");
  reader.finish();
  finer.name = coarse.name;
  return std::make_shared<const RockMaterial>(std::move(finer));
}

std::vector<RockMaterial> read_materials(JsonReader& reader, const std::filesystem::path& folder,
                                         double default_side) {
  const Json* json = reader.child("materials");
  if (!json) return {RockMaterial{}};
  const std::vector<Json>& items = reader.array("materials");
  if (items.empty()) json->fail("\"materials\": at least one material", "none");
  std::vector<RockMaterial> materials;
  std::vector<const Json*> rules;
  for (const Json& item : items) {
    JsonReader material(item);
    rules.push_back(material.child("where"));
    RockMaterial read = read_material(material, folder, default_side);
    if (const Json* finer = material.child("finer")) read.finer = read_finer(*finer, read, folder, default_side);
    material.finish();
    for (const RockMaterial& other : materials)
      if (other.name == read.name) item.fail("a material with a name of its own", "\"" + read.name + "\" for the second time");
    materials.push_back(std::move(read));
  }
  for (std::size_t i = 0; i < materials.size(); ++i)
    if (rules[i]) materials[i].where = read_rule(*rules[i], names_of(materials), folder);
  return materials;
}

/// A layer with its thicknesses: one, or those that repetitions of the sequence take in turn; none where it has a top.
struct ReadLayer {
  Stratum stratum;
  std::vector<double> thickness;
};

ReadLayer read_layer(const Json& json, const std::vector<std::string_view>& names, bool last, const StrataFile& file,
                     bool repeat) {
  JsonReader reader(json);
  ReadLayer layer;
  if (!reader.has("material")) json.fail("a layer with the key \"material\"", "one without");
  layer.stratum.material = static_cast<Label>(reader.choice("material", 0, names));
  const Json* top = reader.child("top");
  const Json* thickness = reader.child("thickness");
  if (top && thickness) thickness->fail("\"top\" or \"thickness\"", "both");
  if (!top && !thickness && (!last || repeat))
    json.fail("a layer with the key \"top\" or \"thickness\"",
              repeat ? "one without, in a sequence that repeats" : "one without; only the last may lack it");
  const Bounds bounds = file.relative_tops ? Bounds{-10.0, 10.0} : Bounds{-12'000.0, 12'000.0};
  layer.stratum.top = top ? reader.number("top", 0.0, bounds) : std::numeric_limits<double>::infinity();
  if (thickness && thickness->type == Json::Type::Array && repeat)
    layer.thickness = reader.numbers("thickness", {}, std::max<std::size_t>(thickness->items.size(), 1), kThickness);
  else if (thickness)
    layer.thickness = {reader.number("thickness", 0.0, kThickness)};
  reader.finish();
  return layer;
}

/// Layers by tops as they are; by thickness, tops above the base, over as many repetitions as lists of thicknesses
/// need.
void read_layers(const std::vector<Json>& items, StrataFile& file, bool repeat) {
  const std::vector<std::string_view> names = names_of(file.materials);
  std::vector<ReadLayer> layers;
  std::size_t rounds = 1;
  for (std::size_t i = 0; i < items.size(); ++i) {
    layers.push_back(read_layer(items[i], names, i + 1 == items.size(), file, repeat));
    const ReadLayer& layer = layers.back();
    const bool thick = !layer.thickness.empty();
    if (i == 0) file.thicknesses = thick;
    if (thick != file.thicknesses && (thick || std::isfinite(layer.stratum.top)))
      items[i].fail("\"top\" in all layers or \"thickness\" in all", "both");
    if (thick) rounds = std::lcm(rounds, layer.thickness.size());
    if (rounds * items.size() > kMostLayers)
      items[i].fail("lists of thicknesses that repeat together within " + std::to_string(kMostLayers) + " layers");
  }
  std::vector<Stratum>& strata = file.strata.layers;
  double top = 0.0;
  for (std::size_t round = 0; round < rounds; ++round)
    for (ReadLayer& layer : layers) {
      if (!layer.thickness.empty()) layer.stratum.top = top += layer.thickness[round % layer.thickness.size()];
      strata.push_back(layer.stratum);
    }
  if (file.thicknesses) return;
  for (std::size_t i = 0; i < items.size(); ++i)
    if (i > 0 ? !(strata[i].top > strata[i - 1].top) : repeat && !(strata[0].top > file.base)) {
      JsonReader layer(items[i]);
      layer.child("top")->fail(i > 0 ? "a \"top\" above that of the layer below; layers go from bottom to top"
                                     : "a \"top\" above the \"base\" of the sequence");
    }
}

Fault read_fault(const Json& json, bool relative) {
  JsonReader reader(json);
  for (const char* key : {"point", "dip_deg", "slip"})
    if (!reader.has(key))
      json.fail("a fault with the keys \"point\", \"dip_deg\" and \"slip\"",
                "one without \"" + std::string(key) + "\"");
  Fault fault;
  const std::vector<double> point = reader.numbers("point", {}, 3);
  fault.point = {point[0], point[1], point[2]};
  if (relative && std::abs(fault.point.z) > 10.0)
    reader.child("point")->fail("\"point\": a relative elevation in [-10, 10]");
  fault.dip = radians(reader.number("dip_deg", 0.0, {0.0, 90.0, true}));
  fault.dip_direction = radians(reader.number("dip_direction_deg", 0.0, {0.0, 360.0}));
  fault.slip = reader.number("slip", 0.0, {-kThickness.hi, kThickness.hi});
  // The displacement must not fold space over.
  if (reader.has("extent"))
    fault.extent = reader.number("extent", 0.0, {std::max(2.0 * std::abs(fault.slip), kThickness.lo), 1e6});
  reader.finish();
  return fault;
}

Fold read_fold(const Json& json) {
  JsonReader reader(json);
  Fold fold;
  fold.amplitude = reader.number("amplitude", fold.amplitude, {0.0, 1000.0});
  fold.wavelength = reader.number("wavelength", fold.wavelength, {0.1, 1e6});
  fold.axis = radians(reader.number("axis_deg", 0.0, {0.0, 360.0}));
  if (fold.amplitude > kSteepestFold * fold.wavelength)
    json.fail("\"fold\": an amplitude of at most a quarter of the wavelength",
              "limbs of " +
                  std::to_string(std::lround(degrees(std::atan(2.0 * kPi * fold.amplitude / fold.wavelength)))) +
                  " degrees");
  reader.finish();
  return fold;
}

MapFile read_map(const Json& json, const std::vector<std::string_view>& names, const std::filesystem::path& folder) {
  JsonReader reader(json);
  MapFile map;
  const Json* image = reader.child("image");
  if (!image) json.fail("a map with the keys \"image\" and \"materials\"", "one without \"image\"");
  map.place = image->place();
  map.image = image_path(*image, folder);
  for (const Json& item : reader.array("materials")) {
    JsonReader entry(item);
    const Json* colour = entry.child("colour");
    if (!colour || !entry.has("material")) item.fail("an entry with the keys \"colour\" and \"material\"");
    std::vector<double> value;
    if (colour->type == Json::Type::Array)
      value = entry.numbers("colour", {}, 3);
    else
      value = {entry.number("colour", 0.0)};
    map.entries.push_back(
        {std::vector<float>(value.begin(), value.end()), static_cast<Label>(entry.choice("material", 0, names))});
    entry.finish();
  }
  if (map.entries.empty()) json.fail("\"materials\": at least one colour and its material", "none");
  reader.finish();
  return map;
}

void read_strata_pile(const Json& json, StrataFile& file, const std::filesystem::path& folder) {
  JsonReader reader(json);
  Strata& strata = file.strata;
  file.relative_tops = reader.choice("tops", 0, {"elevation", "relative"}) == 1;
  const Bounds heights = file.relative_tops ? Bounds{-10.0, 10.0} : Bounds{-12'000.0, 12'000.0};
  const bool repeat = reader.boolean("repeat", false);
  file.base = reader.number("base", 0.0, heights);
  if (repeat) strata.base = file.base;
  const std::vector<Json>& layers = reader.array("layers");
  if (repeat && layers.empty()) reader.child("repeat")->fail("layers to repeat", "none");
  read_layers(layers, file, repeat);
  strata.dip = radians(reader.number("dip_deg", 0.0, {0.0, 60.0}));
  strata.dip_direction = radians(reader.number("dip_direction_deg", 0.0, {0.0, 360.0}));
  strata.undulation = reader.number("undulation", strata.undulation, {0.0, 1000.0});
  if (reader.has("undulation_wavelength"))
    strata.undulation_wavelength = reader.number("undulation_wavelength", strata.undulation_wavelength, kPositive);
  if (const Json* fold = reader.child("fold")) strata.fold = read_fold(*fold);
  for (const Json& fault : reader.array("faults")) strata.faults.push_back(read_fault(fault, file.relative_tops));
  if (strata.faults.size() > kMostFaults)
    reader.child("faults")->fail("\"faults\": at most " + std::to_string(kMostFaults));
  if (const Json* map = reader.child("map")) file.map = read_map(*map, names_of(file.materials), folder);
  const std::vector<double> reference = reader.numbers("reference", {0.0, 0.0}, 2);
  strata.reference = {reference[0], reference[1]};
  reader.finish();
}

Placement read_placement(const Json& json, const std::vector<std::string_view>& names,
                         const std::filesystem::path& folder) {
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
  placement.rim = reader.number("rim", placement.rim, {0.0, 100.0});
  if (const Json* where = reader.child("where")) placement.where = read_rule(*where, names, folder);
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
  return tile_in_place(file, file.materials[material], default_side);
}

TileOptions tile_in_place(const StrataFile& file, const RockMaterial& material, double default_side) {
  TileOptions options = tile_options(material, default_side);
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
  for (const Json& source : reader.array("sources"))
    if (source.type != Json::Type::String) source.fail("a source, as text");
  (void)reader.integer("version", kVersion, kVersion, kVersion);
  file.materials = read_materials(reader, folder, default_side);
  if (const Json* strata = reader.child("strata")) read_strata_pile(*strata, file, folder);
  if (const Json* placement = reader.child("placement"))
    file.placement = read_placement(*placement, names_of(file.materials), folder);
  if (const Json* large = reader.child("large_fractures")) file.large_fractures = read_large_fractures(*large);
  const Vec3f& ground = file.ground_colour;
  const std::vector<double> colour = reader.numbers("ground_colour", {ground.r, ground.g, ground.b}, 3, {0.0, 1.0});
  if (reader.has("ground_colour")) file.ground_colour = Vec3f(colour[0], colour[1], colour[2]);
  file.nodata = reader.choice("nodata", 0, {"hole", "fill"}) == 1 ? NodataPolicy::Fill : NodataPolicy::Hole;
  reader.finish();
  return file;
}

Strata strata_on(const StrataFile& file, const Heightfield& heightfield) {
  Strata strata = file.strata;
  const Interval heights = heightfield.height_bound(heightfield.lo(), heightfield.hi());
  const auto elevation = [&](double given) {
    return file.relative_tops ? heights.lo + given * heights.width() : given;
  };
  const double base = elevation(file.base);
  for (Stratum& layer : strata.layers) layer.top = file.thicknesses ? base + layer.top : elevation(layer.top);
  if (strata.base) strata.base = base;
  strata.reference += heightfield.lo();
  for (Fault& fault : strata.faults) fault.point = Vec3(Vec2(fault.point) + heightfield.lo(), elevation(fault.point.z));
  if (file.map) {
    Image image = read_image(file.map->image);
    if (const std::optional<std::string> wanted = MapImage::misfit(image, heightfield))
      throw InputError(file.map->place + ": \"image\": expected " + *wanted + ", got " + std::to_string(image.width) +
                       " x " + std::to_string(image.height));
    strata.map = MaterialMap(MapImage(std::move(image), heightfield), heightfield, file.map->entries);
  }
  return strata;
}

}  // namespace outcrop

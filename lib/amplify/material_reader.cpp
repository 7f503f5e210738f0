#include "material_reader.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "block_reader.h"
#include "joint_reader.h"
#include "outcrop/core/data_path.h"
#include "target_reader.h"

namespace outcrop {
namespace {

constexpr double kFinestSpacing = 1.0 / 100;   // Of the side: some 700 000 samples.
constexpr double kCoarsestSpacing = 1.0 / 8;   // Of the side: above, a sample would neighbour its own copies.
constexpr double kWidestCrack = 1.0 / 2;       // Of the spacing: wider, and nothing is left of a thin block.
constexpr double kDeepest = 1.0 / 4;           // Of the side: rounding and reliefs.
constexpr Bounds kAnyLength{0.0, 1000.0};      // Metres, where the side is not known yet.
constexpr double kShortestPeriod = 1e-3;       // Metres.
constexpr double kLeastRounding = 1e-6;        // Metres: what a block's field can tell from a sharp edge.
constexpr double kApertureShare = 0.002;       // Of the side: 4 cm at 20 m.
constexpr double kReliefPeriodShare = 0.2;     // Of the side: about a block.
constexpr double kReliefAmplitudeShare = 0.006;  // Of the side: 12 cm at 20 m.
constexpr double kRoundingShare = 0.0125;      // Of the side: 25 cm at 20 m, as in the paper.

/// What rounding and reliefs may take away.
double deepest(double side) { return side > 0.0 ? kDeepest * side : kAnyLength.hi; }

/// 0 when neither spacing nor side is known yet.
double spacing_of(const RockMaterial& material, double side) {
  return material.sample_spacing > 0.0 ? material.sample_spacing : side / kSpacingsPerSide;
}

/// @param side  0: not known yet.
void read_lengths(JsonReader& reader, RockMaterial& material, double side) {
  const bool known = side > 0.0;
  const Bounds spacing = known ? Bounds{side * kFinestSpacing, side * kCoarsestSpacing} : kPositive;
  if (reader.has("sample_spacing")) material.sample_spacing = reader.number("sample_spacing", 0.0, spacing);
  const double widest = kWidestCrack * spacing_of(material, side);
  material.aperture = reader.number("aperture", 0.0, widest > 0.0 ? Bounds{0.0, widest} : kAnyLength);
  material.rounding = zero_or_number(reader, "rounding", {kLeastRounding, deepest(side)});
}

void read_relief_keys(const Json& json, RockMaterial& material, const std::filesystem::path& folder, double side) {
  JsonReader reader(json);
  if (const Json* image = reader.child("image")) material.relief = resolve_relief(*image, folder);
  if (reader.has("period")) material.relief_period = reader.number("period", 0.0, {kShortestPeriod, kAnyLength.hi});
  if (reader.has("amplitude")) material.relief_amplitude = reader.number("amplitude", 0.0, {0.0, deepest(side)});
  reader.finish();
}

std::vector<std::string> known_reliefs() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(data_path() / "reliefs", error))
    if (entry.path().extension() == ".png") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none installed" : text;
}

}  // namespace

double zero_or_number(JsonReader& reader, std::string_view key, const Bounds& bounds) {
  const double value = reader.number(key, 0.0, {0.0, bounds.hi});
  return value == 0.0 ? value : reader.number(key, 0.0, bounds);
}

RockMaterial read_material(JsonReader& reader, const std::filesystem::path& folder, double default_side) {
  RockMaterial material;
  material.name = reader.string("name", material.name);
  const std::vector<std::string_view> types = [] {
    std::vector<std::string_view> names;
    for (const BlockType type : kBlockTypes) names.push_back(name(type));
    return names;
  }();
  material.block_type = kBlockTypes[reader.choice("block_type", 0, types)];
  material.tile_side = reader.has("tile_side") ? reader.number("tile_side", 0.0, {0.1, 1000.0}) : 0.0;
  if (material.tile_side == 0.0 && (has_joint_lengths(reader) || reader.has("blocks"))) material.tile_side = kPatternSide;
  const double side = material.tile_side > 0.0 ? material.tile_side : default_side;
  read_lengths(reader, material, side);
  material.min_block_samples = reader.integer("min_block_samples", material.min_block_samples, 1, 10'000);
  const double joint_side = side > 0.0 ? side : kPatternSide;
  material.joints = read_joints(reader, material.block_type, folder, joint_side, spacing_of(material, joint_side));
  material.target = read_target(reader);
  // A target changes the side: then the tile tells whether blocks fit.
  material.blocks = read_blocks(reader, folder, material.target.any() ? 0.0 : side);
  material.variants = reader.integer("variants", material.blocks.empty() ? material.variants : 1, 1, 64);
  if (!material.blocks.empty() && material.variants > 1)
    reader.child("variants")->fail("\"variants\": 1 in a material with \"blocks\"", std::to_string(material.variants));
  if (const Json* json = reader.child("relief")) read_relief_keys(*json, material, folder, side);
  const Vec3f& c = material.colour;
  const std::vector<double> colour = reader.numbers("colour", {c.r, c.g, c.b}, 3, {0.0, 1.0});
  if (reader.has("colour")) material.colour = Vec3f(colour[0], colour[1], colour[2]);
  return material;
}

std::filesystem::path resolve_relief(const Json& image, const std::filesystem::path& folder) {
  if (image.type != Json::Type::String || image.string.empty()) image.fail("the name or path of a relief image");
  const std::filesystem::path path(image.string);
  std::error_code error;
  if (path.has_extension() || path.has_parent_path()) {
    const std::filesystem::path file = path.is_absolute() ? path : folder / path;
    if (std::filesystem::is_regular_file(file, error)) return file;
    image.fail("a relief image", "\"" + file.string() + "\", which is no file");
  }
  const std::filesystem::path file = data_path() / "reliefs" / (image.string + ".png");
  if (std::filesystem::is_regular_file(file, error)) return file;
  image.fail("a relief image: a path, or one of " + listed(known_reliefs()), "\"" + image.string + "\"");
}

std::filesystem::path find_relief(std::string_view name) {
  const std::filesystem::path file = data_path() / "reliefs" / (std::string(name) + ".png");
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) return file;
  throw InputError(file.string() + ": expected one of the reliefs " + listed(known_reliefs()) + ", got \"" +
                   std::string(name) + "\"");
}

TileOptions tile_options(const RockMaterial& material, double default_side) {
  TileOptions options;
  options.type = material.block_type;
  if (material.joints) options.pattern = *material.joints;
  options.side = material.tile_side > 0.0 ? material.tile_side : default_side;
  options.spacing = material.sample_spacing;
  options.aperture = material.aperture > 0.0 ? material.aperture : kApertureShare * options.side;
  options.rounding = material.rounding > 0.0 ? material.rounding : kRoundingShare * options.side;
  options.min_block_samples = material.min_block_samples;
  options.variants = material.variants;
  options.blocks = material.blocks;
  return options;
}

RockRelief rock_relief(const RockMaterial& material, double tile_side) {
  const double wanted = material.relief_period > 0.0 ? material.relief_period : kReliefPeriodShare * tile_side;
  const double repeats = std::max(1.0, std::round(tile_side / wanted));
  const double amplitude = material.relief_amplitude;
  return {tile_side / repeats, amplitude >= 0.0 ? amplitude : kReliefAmplitudeShare * tile_side};
}

}  // namespace outcrop

#include "outcrop/amplify/scene_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "material_reader.h"
#include "outcrop/amplify/tile_reports.h"
#include "outcrop/core/json.h"
#include "outcrop/fracture/tile.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/implicit/grid_field.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/terrain/read_heightfield.h"
#include "outcrop/terrain/terrain_field.h"
#include "outputs.h"

namespace outcrop {
namespace {

constexpr double kRegionMargin = 0.02;  // Of the support's longest side: air around the solid, so that it closes.
constexpr double kUniverse = 16384.0;   // Metres to each side: where a solid of unknown extent is sought.
constexpr double kSearchCells = 32.0;   // Across the solid, when it is found.
constexpr std::size_t kSearchBoxes = 1 << 15;
constexpr Bounds kFinite{-1e9, 1e9};    // Metres: everything on Earth, and no overflow in squares.
constexpr Bounds kLength{kLeastLength, 1e9};

struct Context {
  std::filesystem::path folder;
  std::vector<std::string> materials;
  Task task;
  std::vector<std::string>& notes;  ///< Of the files that the scene names.
};

FieldPtr read_node(const Json& json, const Context& context);

/// A field with a support that it cannot know itself.
class Supported final : public Field {
 public:
  Supported(FieldPtr field, const Box& box) : field_(std::move(field)), box_(box) {}

  void values(const Points& points, std::span<double> out, std::span<Vec3> gradients) const noexcept override {
    field_->values(points, out, gradients);
  }
  [[nodiscard]] double lipschitz() const noexcept override { return field_->lipschitz(); }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override { return field_->bound(box); }
  [[nodiscard]] FieldPtr narrow(const Box& box) const override { return field_->narrow(box); }
  [[nodiscard]] std::optional<Box> support() const noexcept override { return box_; }
  void labels(const Points& points, std::span<Label> out) const noexcept override { field_->labels(points, out); }

 private:
  FieldPtr field_;
  Box box_;
};

Vec3 vector(JsonReader& reader, std::string_view key, const Vec3& fallback) {
  const std::vector<double> v = reader.numbers(key, {fallback.x, fallback.y, fallback.z}, 3, kFinite);
  return {v[0], v[1], v[2]};
}

Vec3 direction(JsonReader& reader, std::string_view key, const Vec3& fallback) {
  const Vec3 v = vector(reader, key, fallback);
  if (!(glm::length(v) > 0.0)) reader.child(key)->fail("a direction of some length", "[0, 0, 0]");
  return glm::normalize(v);
}

/// The member that must be there.
const Json& needed(JsonReader& reader, std::string_view key) {
  const Json* json = reader.child(key);
  if (!json) reader.json().fail("the key \"" + std::string(key) + "\"", "an object without it");
  return *json;
}

FieldPtr node(JsonReader& reader, std::string_view key, const Context& context) {
  return read_node(needed(reader, key), context);
}

std::vector<FieldPtr> nodes(const Json& json, const Context& context) {
  if (json.type != Json::Type::Array || json.items.empty()) json.fail("an array of at least one field");
  std::vector<FieldPtr> fields;
  for (const Json& item : json.items) fields.push_back(read_node(item, context));
  return fields;
}

std::filesystem::path file(JsonReader& reader, const Context& context) {
  const Json& json = needed(reader, "file");
  if (json.type != Json::Type::String || json.string.empty()) json.fail("the path of a file");
  return context.folder / json.string;
}

FieldPtr read_box(JsonReader& reader, const Context&) {
  const Vec3 lo = vector(reader, "lo", Vec3(-1.0));
  const Vec3 hi = vector(reader, "hi", Vec3(1.0));
  return box_solid({lo, hi}, reader.number("rounding", 0.0, {0.0, 1e9}));
}

FieldPtr read_sphere(JsonReader& reader, const Context&) {
  const Vec3 centre = vector(reader, "centre", Vec3(0.0));
  return sphere(centre, reader.number("radius", 1.0, kLength));
}

FieldPtr read_half_space(JsonReader& reader, const Context&) {
  const Vec3 normal = direction(reader, "normal", {0, 0, 1});
  const Vec3 point = vector(reader, "point", Vec3(0.0));
  return half_space({normal, -glm::dot(normal, point)});
}

FieldPtr read_slab(JsonReader& reader, const Context&) {
  const double floor = reader.number("floor", -1.0, kFinite);
  return slab(floor, reader.number("ceiling", 1.0, kFinite));
}

template <FieldPtr (*Make)(const Vec3&, const Vec3&, double)>
FieldPtr read_rod(JsonReader& reader, const Context&) {
  const Vec3 a = vector(reader, "a", {0, 0, -1});
  const Vec3 b = vector(reader, "b", {0, 0, 1});
  return Make(a, b, reader.number("radius", 1.0, kLength));
}

FieldPtr read_torus(JsonReader& reader, const Context&) {
  const Vec3 centre = vector(reader, "centre", Vec3(0.0));
  const Vec3 axis = direction(reader, "axis", {0, 0, 1});
  const double major = reader.number("major_radius", 1.0, kLength);
  return torus(centre, axis, major, reader.number("minor_radius", 0.25, kLength));
}

FieldPtr read_difference(JsonReader& reader, const Context& context) {
  FieldPtr a = node(reader, "a", context);
  return difference_of(std::move(a), node(reader, "b", context));
}

FieldPtr read_smooth_union(JsonReader& reader, const Context& context) {
  const double radius = reader.number("radius", 0.25, {0.0, 1e9});
  return smooth_union_of(nodes(needed(reader, "of"), context), radius);
}

FieldPtr read_smooth_intersection(JsonReader& reader, const Context& context) {
  const double radius = reader.number("radius", 0.25, {0.0, 1e9});
  return smooth_intersection_of(nodes(needed(reader, "of"), context), radius);
}

FieldPtr read_smooth_difference(JsonReader& reader, const Context& context) {
  const double radius = reader.number("radius", 0.25, {0.0, 1e9});
  FieldPtr a = node(reader, "a", context);
  return smooth_difference_of(std::move(a), node(reader, "b", context), radius);
}

/// The rotation by `angle` about the unit vector `u` (Rodrigues).
Mat3 rotation_about(const Vec3& u, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Mat3 m;
  for (int column = 0; column < 3; ++column) {
    Vec3 e(0.0);
    e[column] = 1.0;
    m[column] = c * e + s * glm::cross(u, e) + (1.0 - c) * glm::dot(u, e) * u;
  }
  return m;
}

FieldPtr read_transform(JsonReader& reader, const Context& context) {
  const Vec3 axis = direction(reader, "axis", {0, 0, 1});
  const double angle = radians(reader.number("rotate_deg", 0.0, {-360.0, 360.0}));
  const double scale = reader.number("scale", 1.0, kLength);
  const Vec3 translation = vector(reader, "translate", Vec3(0.0));
  return transformed(node(reader, "of", context), rotation_about(axis, angle), scale, translation);
}

FieldPtr read_offset(JsonReader& reader, const Context& context) {
  const double thickness = reader.number("thickness", 0.0, kFinite);
  return offset(node(reader, "of", context), thickness);
}

FieldPtr read_shell(JsonReader& reader, const Context& context) {
  const double thickness = reader.number("thickness", 0.1, kLength);
  return shell(node(reader, "of", context), thickness);
}

FieldPtr read_noise(JsonReader& reader, const Context& context) {
  const double amplitude = reader.number("amplitude", 0.1, {0.0, 1e6});
  const double wavelength = reader.number("wavelength", 1.0, kLength);
  const int octaves = reader.integer("octaves", 4, 1, 16);
  const int seed = reader.integer("seed", 1, 0, std::numeric_limits<int>::max());
  return with_noise(node(reader, "of", context), amplitude, wavelength, octaves, static_cast<std::uint64_t>(seed));
}

FieldPtr read_warp(JsonReader& reader, const Context& context) {
  const double period = reader.number("period", 4.0, kLength);
  Warp warp;
  warp.relief = read_relief(resolve_relief(needed(reader, "relief"), context.folder), period);
  warp.amplitude = reader.number("amplitude", 0.1, {0.0, 1e6});
  return warped(node(reader, "of", context), warp);
}

FieldPtr read_terrain(JsonReader& reader, const Context& context) {
  HeightfieldOptions options;
  if (reader.has("cell_size")) options.cell_size = reader.number("cell_size", 1.0, kLength);
  options.height_scale = reader.number("height_scale", 1.0, kFinite);
  options.height_offset = reader.number("height_offset", 0.0, kFinite);
  const bool bilinear = reader.boolean("bilinear", false);
  const bool fill = reader.choice("nodata", 0, {"hole", "fill"}) == 1;
  const std::filesystem::path path = file(reader, context);
  HeightfieldFile read = read_heightfield(path, options);
  for (const std::string& note : read.notes) context.notes.push_back(path.string() + ": " + note);
  Heightfield heightfield(std::move(read.grid), bilinear ? Interpolation::Bilinear : Interpolation::Smooth);
  return std::make_shared<TerrainField>(std::move(heightfield), fill ? NodataPolicy::Fill : NodataPolicy::Hole);
}

FieldPtr read_mesh_node(JsonReader& reader, const Context& context) {
  const double voxel = reader.has("voxel") ? reader.number("voxel", 1.0, kLength) : 0.0;
  MeshField mesh = mesh_field(file(reader, context), voxel, context.task);
  if (!mesh.note.empty()) context.notes.push_back(mesh.note);
  return mesh.field;
}

FieldPtr read_vdb_node(JsonReader& reader, const Context& context) { return read_vdb(file(reader, context), context.task); }

FieldPtr read_label(JsonReader& reader, const Context& context) {
  if (context.materials.empty()) reader.json().fail("\"materials\" at the top of the scene, to name one", "none");
  const std::vector<std::string_view> names(context.materials.begin(), context.materials.end());
  (void)needed(reader, "material");
  const std::size_t label = reader.choice("material", 0, names);
  return labelled(node(reader, "of", context), static_cast<Label>(label));
}

/// The blocks of one fracture tile; `explode` moves their centres apart, so that each can be seen.
FieldPtr read_tile(JsonReader& reader, const Context& context) {
  const double explode = reader.number("explode", 1.0, {1.0, 100.0});
  const int seed = reader.integer("seed", 1, 0, std::numeric_limits<int>::max());
  // A tile by itself lies as it was made: no lattice turns it.
  StrataFile alone{.materials = {read_material(reader, context.folder, TileOptions{}.side)}};
  alone.placement.lattice_azimuth = 0.0;
  const RockMaterial material =
      meet_targets(std::move(alone), TileOptions{}.side, static_cast<Seed>(seed), context.task).file.materials[0];
  TileOptions options = tile_options(material, TileOptions{}.side);
  options.variants = 1;  // One tile is all that is shown.
  const Tile tile = make_tile(options, static_cast<Seed>(seed), context.task);
  Warp warp;
  if (!material.relief.empty() && material.relief_amplitude != 0.0) {
    const RockRelief relief = rock_relief(material, options.side);
    warp = {read_relief(material.relief, relief.period), relief.amplitude};
  }
  std::vector<FieldPtr> blocks;
  for (const Block& block : tile.blocks) {
    const Vec3 middle(0.5 * tile.side);
    const Block& whole = *(&block - block.part);  // Its parts stay together.
    const Vec3 centre = block.home + (explode - 1.0) * (whole.home - middle);
    PolytopeKernel kernel(block.planes, block.rounding, warp, block.centre);
    blocks.push_back(std::make_shared<Supported>(std::make_shared<RoundedPolytope>(std::move(kernel), centre),
                                                 block.bounds.moved(centre)));
  }
  return union_of(std::move(blocks));
}

struct Kind {
  std::string_view name;
  FieldPtr (*read)(JsonReader&, const Context&);
};

/// Nodes whose value is an object; "union" and "intersection" hold an array and are read in read_node.
constexpr Kind kKinds[] = {
    {"box", read_box},
    {"capsule", read_rod<capsule>},
    {"cylinder", read_rod<cylinder>},
    {"difference", read_difference},
    {"half_space", read_half_space},
    {"heightfield", read_terrain},
    {"label", read_label},
    {"mesh", read_mesh_node},
    {"noise", read_noise},
    {"offset", read_offset},
    {"shell", read_shell},
    {"slab", read_slab},
    {"smooth_difference", read_smooth_difference},
    {"smooth_intersection", read_smooth_intersection},
    {"smooth_union", read_smooth_union},
    {"sphere", read_sphere},
    {"tile", read_tile},
    {"torus", read_torus},
    {"transform", read_transform},
    {"vdb", read_vdb_node},
    {"warp", read_warp},
};

[[noreturn]] void refuse_kind(const Json& json, const std::string& kind) {
  std::vector<std::string_view> names{"union", "intersection"};
  for (const Kind& known : kKinds) names.push_back(known.name);
  std::sort(names.begin(), names.end());
  const std::string_view nearest = nearest_name(kind, names.data(), names.size());
  if (!nearest.empty()) json.fail("a kind of field such as \"" + std::string(nearest) + "\"", "\"" + kind + "\"");
  std::string list;
  for (const std::string_view name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  json.fail("one of " + list, "\"" + kind + "\"");
}

FieldPtr read_node(const Json& json, const Context& context) {
  context.task.check();
  if (json.type != Json::Type::Object) json.fail("a field: an object with one key, its kind");
  if (json.members.size() != 1)
    json.fail("a field: an object with one key, its kind", std::to_string(json.members.size()) + " keys");
  const auto& [kind, body] = json.members.front();
  try {
    if (kind == "union") return union_of(nodes(body, context));
    if (kind == "intersection") return intersection_of(nodes(body, context));
    for (const Kind& known : kKinds)
      if (known.name == kind) {
        JsonReader reader(body);
        FieldPtr field = known.read(reader, context);
        reader.finish();
        return field;
      }
  } catch (const ParameterError& error) {
    throw InputError(body.place() + ": " + kind + ": " + error.what());
  }
  refuse_kind(body, kind);
}

Box read_region(const Json& json) {
  if (json.type != Json::Type::Array || json.items.size() != 2) json.fail("[[x0, y0, z0], [x1, y1, z1]]");
  Box box;
  for (std::size_t corner = 0; corner < 2; ++corner) {
    const Json& items = json.items[corner];
    if (items.type != Json::Type::Array || items.items.size() != 3) items.fail("three numbers");
    for (int axis = 0; axis < 3; ++axis) {
      const Json& number = items.items[static_cast<std::size_t>(axis)];
      if (number.type != Json::Type::Number || std::abs(number.number) > kFinite.hi) number.fail("a number of metres");
      (corner == 0 ? box.lo : box.hi)[axis] = number.number;
    }
  }
  for (int axis = 0; axis < 3; ++axis)
    if (!(box.lo[axis] < box.hi[axis])) json.fail("a region whose first corner is the lower one on every axis");
  return box;
}

void read_materials(JsonReader& reader, Scene& scene) {
  for (const Json& item : reader.array("materials")) {
    JsonReader material(item);
    const std::string name = material.string("name", "rock");
    if (std::find(scene.label_names.begin(), scene.label_names.end(), name) != scene.label_names.end())
      item.fail("a material with a name of its own", "\"" + name + "\" for the second time");
    const Vec3f grey = RockMaterial{}.colour;
    const std::vector<double> c = material.numbers("colour", {grey.r, grey.g, grey.b}, 3, {0.0, 1.0});
    material.finish();
    scene.label_names.push_back(name);
    scene.label_colours.emplace_back(c[0], c[1], c[2]);
  }
}

/// Where the field may be negative, from its bounds alone: nothing when it reaches the end of the universe.
std::optional<Box> found_by_bounds(const Field& field) {
  const Box universe{Vec3(-kUniverse), Vec3(kUniverse)};
  std::vector<Box> boxes{universe};
  for (double size = kUniverse; !boxes.empty(); size *= 0.5) {
    std::vector<Box> smaller;
    Box found;
    for (const Box& box : boxes)
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 lo = box.lo + size * Vec3(corner & 1, (corner >> 1) & 1, corner >> 2);
        const Box child{lo, lo + size};
        if (field.bound(child).lo > 0.0) continue;
        smaller.push_back(child);
        found = hull(found, child);
      }
    boxes = std::move(smaller);
    const Vec3 extent = found.size();
    const double longest = std::max({extent.x, extent.y, extent.z});
    if (boxes.size() < kSearchBoxes && size * kSearchCells > longest) continue;
    const bool inside = glm::all(glm::greaterThan(found.lo, universe.lo)) && glm::all(glm::lessThan(found.hi, universe.hi));
    return inside ? std::optional(found) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Box> default_region(const Field& field) {
  std::optional<Box> support = field.support();
  if (!support) support = found_by_bounds(field);
  if (!support || support->empty()) return std::nullopt;
  const Vec3 size = support->size();
  const double longest = std::max({size.x, size.y, size.z});
  if (!std::isfinite(longest)) return std::nullopt;
  return support->grown(kRegionMargin * longest);
}

Scene read_scene(const std::filesystem::path& path, const Task& task) {
  const Json json = read_json(path);
  JsonReader reader(json);
  Scene scene;
  (void)reader.string("$schema", "");
  (void)reader.string("description", "");
  (void)reader.integer("version", 1, 1, 1);
  read_materials(reader, scene);
  if (const Json* region = reader.child("region")) scene.region = read_region(*region);
  if (reader.has("resolution")) scene.resolution = reader.number("resolution", 1.0, kLength);
  const Json* field = reader.child("field");
  reader.finish();  // Before the field: a misspelt key is told at once, not after minutes of reading files.
  if (!field) json.fail("a scene with the key \"field\"", "one without");
  scene.field = read_node(*field, {path.parent_path(), scene.label_names, task, scene.notes});
  if (!scene.region) scene.region = default_region(*scene.field);
  if (scene.label_names.empty()) {
    scene.label_names = {RockMaterial{}.name};
    scene.label_colours = {RockMaterial{}.colour};
  }
  return scene;
}

}  // namespace outcrop

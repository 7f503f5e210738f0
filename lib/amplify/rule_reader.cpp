#include "rule_reader.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "material_reader.h"

namespace outcrop {
namespace {

using Kind = PlacementRule::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 14> kKinds{{{"slope_deg", Kind::Slope},
                                                                    {"aspect_deg", Kind::Aspect},
                                                                    {"curvature", Kind::Curvature},
                                                                    {"altitude", Kind::Altitude},
                                                                    {"water_level", Kind::Water},
                                                                    {"distance", Kind::Distance},
                                                                    {"mask", Kind::Mask},
                                                                    {"polygon", Kind::Polygon},
                                                                    {"box", Kind::Box},
                                                                    {"sphere", Kind::Sphere},
                                                                    {"material", Kind::Material},
                                                                    {"all", Kind::All},
                                                                    {"any", Kind::Any},
                                                                    {"not", Kind::Not}}};
constexpr double kFarthest = 1e6;  // Metres: softness and scales beyond make no difference.

/// Two numbers in order, null for an open end.
std::pair<double, double> read_range(const Json& json, std::string_view key, const Bounds& bounds) {
  const std::string name = "\"" + std::string(key) + "\": ";
  if (json.type != Json::Type::Array || json.items.size() != 2) json.fail(name + "[from, to], null for an open end");
  std::array<double, 2> ends{bounds.lo, bounds.hi};
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& item = json.items[i];
    if (item.type == Json::Type::Null) continue;
    if (item.type != Json::Type::Number) item.fail(name + "a number, or null for an open end");
    if (item.number < bounds.lo || item.number > bounds.hi)
      item.fail(name + "numbers in [" + std::to_string(std::lround(bounds.lo)) + ", " +
                std::to_string(std::lround(bounds.hi)) + "]");
    ends[i] = item.number;
  }
  return {ends[0], ends[1]};
}

void read_ordered_range(PlacementRule& rule, const Json& json, std::string_view key, const Bounds& bounds = {}) {
  std::tie(rule.lo, rule.hi) = read_range(json, key, bounds);
  if (rule.lo > rule.hi) json.fail("\"" + std::string(key) + "\": the lower end before the upper");
}

std::vector<Vec2> read_polygon(const Json& json) {
  const std::string wanted = "\"polygon\": three or more corners [x, y]";
  if (json.type != Json::Type::Array) json.fail(wanted);
  std::vector<Vec2> polygon;
  for (const Json& item : json.items) {
    if (item.type != Json::Type::Array || item.items.size() != 2 || item.items[0].type != Json::Type::Number ||
        item.items[1].type != Json::Type::Number)
      item.fail("\"polygon\": corners [x, y], metres east and north of the terrain's south-west corner");
    polygon.emplace_back(item.items[0].number, item.items[1].number);
  }
  if (polygon.size() < 3) json.fail(wanted, std::to_string(polygon.size()));
  for (std::size_t i = 0; i < polygon.size(); ++i)
    if (polygon[i] == polygon[(i + 1) % polygon.size()])
      json.items[i].fail("\"polygon\": corners that differ from the next; the last joins the first by itself",
                         "corner " + std::to_string(i + 1) + " twice");
  if (const auto sides = crossing_sides(polygon))
    json.items[sides->second].fail(
        "\"polygon\": sides that do not cross",
        "side " + std::to_string(sides->second + 1) + " across side " + std::to_string(sides->first + 1));
  return polygon;
}

Box read_box(const Json& json) {
  JsonReader reader(json);
  for (const char* key : {"lo", "hi"})
    if (!reader.has(key))
      json.fail("\"box\" with the keys \"lo\" and \"hi\"", "one without \"" + std::string(key) + "\"");
  const std::vector<double> lo = reader.numbers("lo", {}, 3), hi = reader.numbers("hi", {}, 3);
  for (int axis = 0; axis < 3; ++axis)
    if (!(lo[axis] < hi[axis])) reader.child("hi")->fail("\"hi\": more than \"lo\" along each axis");
  reader.finish();
  return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

void read_sphere(PlacementRule& rule, const Json& json) {
  JsonReader reader(json);
  for (const char* key : {"centre", "radius"})
    if (!reader.has(key))
      json.fail("\"sphere\" with the keys \"centre\" and \"radius\"", "one without \"" + std::string(key) + "\"");
  const std::vector<double> centre = reader.numbers("centre", {}, 3);
  rule.centre = {centre[0], centre[1], centre[2]};
  rule.radius = reader.number("radius", 0.0, kPositive);
  reader.finish();
}

Label read_material_name(const Json& json, const std::vector<std::string_view>& materials) {
  // The reader's own words for a wrong name, with the nearest.
  Json object{.type = Json::Type::Object,
              .members = {{"material", json}},
              .file = json.file,
              .line = json.line,
              .column = json.column};
  return static_cast<Label>(JsonReader(object).choice("material", 0, materials));
}

void read_parts(PlacementRule& rule, const Json& json, std::string_view key,
                const std::vector<std::string_view>& materials, const std::filesystem::path& folder) {
  if (json.type != Json::Type::Array || json.items.empty()) json.fail("\"" + std::string(key) + "\": a list of rules");
  for (const Json& item : json.items) rule.parts.push_back(read_rule(item, materials, folder));
}

}  // namespace

std::filesystem::path image_path(const Json& json, const std::filesystem::path& folder) {
  if (json.type != Json::Type::String || json.string.empty()) json.fail("the path of an image");
  const std::filesystem::path path(json.string);
  const std::filesystem::path file = path.is_absolute() ? path : folder / path;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    json.fail("the path of an image", "\"" + file.string() + "\", which is no file");
  return file;
}

PlacementRule read_rule(const Json& json, const std::vector<std::string_view>& materials,
                        const std::filesystem::path& folder) {
  JsonReader reader(json);
  const Json* found = nullptr;
  std::string_view key;
  std::string known;
  PlacementRule rule;
  rule.place = json.place();
  for (const auto& [name, kind] : kKinds) {
    known += (known.empty() ? "" : ", ") + std::string(name);
    const Json* member = reader.child(name);
    if (!member) continue;
    if (found)
      member->fail("one kind of rule each; \"all\" and \"any\" combine them",
                   "\"" + std::string(key) + "\" and \"" + std::string(name) + "\"");
    found = member, key = name, rule.kind = kind;
  }
  if (!found) {
    for (const char* option : {"soft", "scale", "density", "height"}) (void)reader.has(option);
    reader.finish();
    json.fail("a rule, one of " + known, "none");
  }
  rule.place = found->place();
  const bool border = rule.kind != Kind::Mask && rule.kind != Kind::Material && rule.kind != Kind::All &&
                      rule.kind != Kind::Any && rule.kind != Kind::Not;
  const bool angle = rule.kind == Kind::Slope || rule.kind == Kind::Aspect;
  const bool scaled = angle || rule.kind == Kind::Curvature;
  if (border) rule.soft = reader.number("soft", 0.0, {0.0, angle ? 180.0 : kFarthest});
  if (scaled && reader.has("scale")) rule.scale = reader.number("scale", 0.0, {0.0, kFarthest, true});
  rule.density = reader.number("density", 1.0, {0.0, 1.0, true});
  if (rule.kind == Kind::Water) {
    rule.lo = 0.0;
    if (const Json* height = reader.child("height")) read_ordered_range(rule, *height, "height");
  }
  reader.finish();
  switch (rule.kind) {
    case Kind::Slope:
      read_ordered_range(rule, *found, key, {0.0, 90.0});
      break;
    case Kind::Aspect:
      std::tie(rule.lo, rule.hi) = read_range(*found, key, {0.0, 360.0});
      break;
    case Kind::Curvature:
    case Kind::Altitude:
    case Kind::Distance:
      read_ordered_range(rule, *found, key);
      break;
    case Kind::Water:
      rule.water_level = reader.number(key, 0.0);
      break;
    case Kind::Mask:
      rule.image = image_path(*found, folder);
      break;
    case Kind::Polygon:
      rule.polygon = read_polygon(*found);
      break;
    case Kind::Box:
      rule.box = read_box(*found);
      break;
    case Kind::Sphere:
      read_sphere(rule, *found);
      break;
    case Kind::Material:
      if (found->type == Json::Type::Array && !found->items.empty())
        for (const Json& item : found->items) rule.materials.push_back(read_material_name(item, materials));
      else
        rule.materials.push_back(read_material_name(*found, materials));
      break;
    case Kind::All:
    case Kind::Any:
      read_parts(rule, *found, key, materials, folder);
      break;
    case Kind::Not:
      rule.parts.push_back(read_rule(*found, materials, folder));
      break;
  }
  if (angle) {
    for (double* value : {&rule.lo, &rule.hi, &rule.soft}) *value = radians(*value);
  }
  return rule;
}

}  // namespace outcrop

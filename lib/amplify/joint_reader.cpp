#include "joint_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "material_reader.h"
#include "outcrop/core/error.h"
#include "outcrop/fracture/orientations.h"

namespace outcrop {
namespace {

constexpr double kWidestDisc = 10.0;         // Of the side: a plane.
constexpr double kWidestColumn = 1.0 / 5;    // Of the side; the thinnest is a sample wide.
constexpr double kFinestGap = 1.0 / 1000;    // Of the side.
constexpr double kThickest = 1.0 / 4;        // Of the side: stress shadows.
constexpr Bounds kAnyLength{0.0, 1000.0};    // Metres.
constexpr Bounds kVariation{.lo = 0.0, .hi = 5.0, .open_lo = true};
constexpr int kMostClusters = 20;
constexpr const char* kJointKeys[] = {"joint_sets", "discs", "irregular_share", "centre_spacing", "column_width",
                                      "columns", "discs_at", "covered_share", "least_thickness", "least_angle_deg"};
// Those of them, and of a set, that are lengths.
constexpr const char* kLengthKeys[] = {"centre_spacing", "column_width", "columns", "discs_at", "least_thickness"};
constexpr const char* kSetLengthKeys[] = {"radius", "radius_mean", "spacing", "p32"};

Vec3 read_normal(JsonReader& reader) {
  const double dip = reader.number("dip_deg", 0.0, {0.0, 90.0});
  const double direction = reader.number("dip_direction_deg", 0.0, {0.0, 360.0});
  return normal_of({radians(dip), radians(direction)});
}

std::vector<Vec3> read_measured(const Json& json, const std::filesystem::path& folder) {
  if (json.type != Json::Type::String || json.string.empty()) json.fail("a text file of dips and dip directions");
  const std::filesystem::path path(json.string);
  const std::filesystem::path file = path.is_absolute() ? path : folder / path;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    json.fail("a text file of dips and dip directions", "\"" + file.string() + "\", which is no file");
  std::vector<Vec3> normals;
  for (const Orientation& orientation : read_orientations(file)) normals.push_back(normal_of(orientation));
  return normals;
}

void read_orientation(JsonReader& reader, JointSet& set, const std::filesystem::path& folder) {
  const bool turned = reader.has("dip_deg") || reader.has("dip_direction_deg");
  if (const Vec3 normal = read_normal(reader); turned) set.normal = normal;
  const Json* measured = reader.child("orientations");
  if (measured) {
    set.measured = read_measured(*measured, folder);
    if (!turned) set.normal = axis_statistics(set.measured).mean;
  }
  set.kappa = reader.number("kappa", set.kappa, kPositive);
  constexpr JointFrame kFrames[] = {JointFrame::Map, JointFrame::Bedding, JointFrame::Tile};
  const bool in_map = turned || measured;
  set.frame = kFrames[reader.choice("frame", in_map ? 0 : 2, {"map", "bedding", "tile"})];
}

void read_amount(JsonReader& reader, JointSet& set, double side) {
  int ways = 0;
  for (const char* key : {"share", "spacing", "p32"}) ways += reader.has(key);
  if (ways > 1) reader.json().fail("a joint set with one of the keys \"share\", \"spacing\" and \"p32\"", "several");
  if (ways == 1) set.spacing = set.p32 = 0.0;
  set.share = reader.number("share", set.share, kPositive);
  if (reader.has("spacing")) set.spacing = reader.number("spacing", 0.0, {kFinestGap * side, side});
  if (reader.has("p32")) set.p32 = reader.number("p32", 0.0, {1.0 / (1000.0 * side), 1.0 / (kFinestGap * side)});
  constexpr SpacingLaw kLaws[] = {SpacingLaw::Fixed, SpacingLaw::Exponential, SpacingLaw::Lognormal};
  set.spacing_law = kLaws[reader.choice("spacing_law", static_cast<std::size_t>(set.spacing_law),
                                        {"fixed", "exponential", "lognormal"})];
  set.spacing_cv = reader.number("spacing_cv", set.spacing_cv, kVariation);
  set.persistence = reader.number("persistence", set.persistence, {.lo = 0.0, .hi = 1.0, .open_lo = true});
}

void read_radius(JsonReader& reader, JointSet& set, double side) {
  const Bounds bounds{.lo = 0.0, .hi = kWidestDisc * side, .open_lo = true};
  constexpr RadiusLaw kLaws[] = {RadiusLaw::Uniform, RadiusLaw::PowerLaw, RadiusLaw::Lognormal};
  const Json* key = reader.child("radius");
  if (key && key->type == Json::Type::String) {
    (void)reader.choice("radius", 0, {"persistent"});
    set.radius_law = RadiusLaw::Persistent;
  } else if (key) {
    set.radius_law = RadiusLaw::Uniform;
    const bool single = key->type == Json::Type::Number;
    const std::vector<double> radius =
        single ? std::vector<double>(2, reader.number("radius", 0.0, bounds)) : reader.numbers("radius", {}, 2, bounds);
    if (radius[0] > radius[1]) key->fail("\"radius\": the smallest before the largest");
    set.radius_lo = radius[0];
    set.radius_hi = radius[1];
    set.radius_mean = std::sqrt(radius[0] * radius[1]);
  } else if (reader.has("spacing") && !reader.has("persistence")) {
    set.radius_law = RadiusLaw::Persistent;  // who gives a spacing alone means joints that go on
  }
  if (reader.has("radius_law")) {
    const std::size_t law = reader.choice("radius_law", 0, {"uniform", "power_law", "lognormal"});
    if (set.radius_law == RadiusLaw::Persistent)
      reader.child("radius_law")->fail("a \"radius_law\" beside a \"radius\" in metres", "a persistent set");
    set.radius_law = kLaws[law];
  }
  set.radius_exponent = reader.number("radius_exponent", set.radius_exponent, {.lo = 0.0, .hi = 20.0, .open_lo = true});
  if (reader.has("radius_mean")) set.radius_mean = reader.number("radius_mean", 0.0, {set.radius_lo, set.radius_hi});
  set.radius_cv = reader.number("radius_cv", set.radius_cv, kVariation);
  if (set.radius_law == RadiusLaw::Persistent && set.spacing == 0.0 && set.p32 == 0.0)
    reader.json().fail("a \"spacing\" or \"p32\" for a persistent joint set", "neither");
}

/// Lengths are metres of this tile.
JointSet read_joint_set(JsonReader& reader, JointSet set, const std::filesystem::path& folder, double side) {
  set.name = reader.string("name", set.name);
  if (set.name == kColumns) reader.child("name")->fail("a name other than \"columns\"");
  read_orientation(reader, set, folder);
  read_amount(reader, set, side);
  read_radius(reader, set, side);
  if (reader.has("ends_at")) set.ends_at.clear();
  for (const Json& name : reader.array("ends_at")) {
    if (name.type != Json::Type::String) name.fail("the name of a joint set, or \"columns\"");
    set.ends_at.push_back(name.string);
  }
  set.ends_share = reader.number("ends_share", set.ends_share, {0.0, 1.0});
  return set;
}

std::vector<JointSet> read_listed_sets(const std::vector<Json>& items, const std::vector<JointSet>& presets,
                                       const std::filesystem::path& folder, double side) {
  std::vector<JointSet> sets;
  for (std::size_t i = 0; i < items.size(); ++i) {
    JsonReader reader(items[i]);
    JointSet set = i < presets.size() ? presets[i] : JointSet{.name = "set " + std::to_string(i + 1)};
    set = read_joint_set(reader, std::move(set), folder, side);
    reader.finish();
    for (const JointSet& other : sets)
      if (other.name == set.name)
        items[i].fail("a joint set with a name of its own", "\"" + set.name + "\" for the second time");
    sets.push_back(std::move(set));
  }
  return sets;
}

/// One set for each cluster of measured orientations; whatever else the object says holds for all of them.
std::vector<JointSet> read_clustered_sets(const Json& json, const std::filesystem::path& folder, double side) {
  JsonReader reader(json);
  const Json* file = reader.child("orientations");
  if (!file) json.fail("an array of joint sets, or an object with the key \"orientations\"");
  const std::vector<Vec3> normals = read_measured(*file, folder);
  int wanted = 0;
  if (const Json* clusters = reader.child("clusters"); clusters && clusters->type == Json::Type::String)
    (void)reader.choice("clusters", 0, {"auto"});
  else
    wanted = reader.integer("clusters", 0, 1, kMostClusters);
  const JointSet common = read_joint_set(reader, {}, folder, side);
  reader.finish();
  std::vector<JointSet> sets;
  for (const FoundSet& found : find_joint_sets(normals, {.sets = wanted}).sets) {
    JointSet set = common;
    set.name = "set " + std::to_string(sets.size() + 1);
    set.measured.clear();
    set.normal = found.statistics.mean;
    if (std::isfinite(found.statistics.kappa) && found.statistics.kappa > 0.0) set.kappa = found.statistics.kappa;
    const auto members = static_cast<double>(found.members.size());
    if (set.spacing == 0.0 && set.p32 == 0.0) set.share = members;
    sets.push_back(std::move(set));
  }
  if (sets.empty()) file->fail("orientations that gather in sets", "none that do");
  return sets;
}

// Sets that stand where the file has them: what they end at is known, and older.
void check_terminations(const Json& json, const std::vector<JointSet>& sets, bool has_columns) {
  for (const JointSet& set : sets)
    for (const std::string& name : set.ends_at) {
      if (name == kColumns && has_columns) continue;
      if (name == kColumns) json.fail("\"columns\" in the material for set \"" + set.name + "\" to end at", "none");
      std::vector<std::string_view> names;
      for (const JointSet& other : sets) names.push_back(other.name);
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      const std::string_view nearest = nearest_name(name, names.data(), names.size());
      json.fail("the name of a joint set that \"" + set.name + "\" ends at",
                "\"" + name + "\"" + (nearest.empty() ? "" : "; did you mean \"" + std::string(nearest) + "\"?"));
    }
  if (const std::string cycle = termination_cycle(sets); !cycle.empty())
    json.fail("joint sets of which some end at none of the others", "a cycle: " + cycle);
}

void check_closed(const Json& json, const JointPattern& pattern) {
  const bool one_frame = std::all_of(pattern.sets.begin(), pattern.sets.end(),
                                     [&](const JointSet& set) { return set.frame == pattern.sets[0].frame; });
  if (!one_frame) return;  // what they have in common is known when the rock lies in the world
  const std::optional<Vec3> open = open_direction(pattern);
  if (!open) return;
  const Orientation closing = orientation_of(*open);
  char text[240];
  std::snprintf(text, sizeof text,
                "blocks that stay open along the direction that plunges %.0f degrees towards %.0f; a set with "
                "\"dip_deg\": %.0f and \"dip_direction_deg\": %.0f closes them",
                degrees(0.5 * kPi - closing.dip), std::fmod(degrees(closing.dip_direction) + 180.0, 360.0),
                degrees(closing.dip), degrees(closing.dip_direction));
  json.fail("joint sets that close blocks in all directions", text);
}

std::vector<ColumnTier> read_columns(const Json& json, const std::vector<Json>& items, const Bounds& width) {
  if (items.empty()) json.fail("\"columns\": at least one tier", "none");
  std::vector<ColumnTier> tiers;
  for (const Json& item : items) {
    JsonReader reader(item);
    if (!reader.has("width")) item.fail("a tier of columns with the key \"width\"", "one without");
    ColumnTier tier;
    tier.width = reader.number("width", 0.0, width);
    tier.irregularity = reader.number("irregularity", tier.irregularity, {0.0, 1.0});
    tier.height = reader.number("height", tier.height, {0.01, 100.0});
    reader.finish();
    tiers.push_back(tier);
  }
  return tiers;
}

std::vector<Disc> read_discs(const std::vector<Json>& items, double side) {
  std::vector<Disc> discs;
  for (const Json& item : items) {
    JsonReader reader(item);
    for (const char* key : {"centre", "radius"})
      if (!reader.has(key)) item.fail("a disc with the keys \"centre\" and \"radius\"", "one without");
    const std::vector<double> centre = reader.numbers("centre", {}, 3, {0.0, side});
    Disc disc;
    disc.centre = {centre[0], centre[1], centre[2]};
    disc.radius = reader.number("radius", 0.0, {.lo = 0.0, .hi = kWidestDisc * side, .open_lo = true});
    disc.normal = read_normal(reader);
    reader.finish();
    discs.push_back(disc);
  }
  return discs;
}

}  // namespace

std::optional<JointPattern> read_joints(JsonReader& reader, BlockType type, const std::filesystem::path& folder,
                                        double side, double spacing) {
  bool given = false;
  for (const char* key : kJointKeys) given = reader.has(key) || given;  // so that the reader knows them all
  if (!given) return std::nullopt;
  JointPattern pattern = joint_pattern(type, side);
  const Json* sets = reader.child("joint_sets");
  if (sets && sets->type == Json::Type::Object) {
    pattern.sets = read_clustered_sets(*sets, folder, side);
  } else if (sets) {
    const std::vector<Json>& items = reader.array("joint_sets");
    if (items.empty()) sets->fail("\"joint_sets\": at least one joint set", "none");
    pattern.sets = read_listed_sets(items, pattern.sets, folder, side);
  }
  pattern.discs = reader.integer("discs", pattern.discs, 0, 10'000);
  pattern.irregular_share = reader.number("irregular_share", pattern.irregular_share, {0.0, 1.0});
  pattern.centre_spacing = reader.number("centre_spacing", pattern.centre_spacing, kAnyLength);
  pattern.covered_share = reader.number("covered_share", pattern.covered_share, {0.0, 1.0});
  pattern.least_thickness = reader.number("least_thickness", pattern.least_thickness, {0.0, kThickest * side});
  if (reader.has("least_angle_deg"))
    pattern.least_angle = radians(reader.number("least_angle_deg", 0.0, {0.0, 60.0}));
  const Bounds width{spacing, kWidestColumn * side};
  if (const Json* columns = reader.child("columns")) {
    if (reader.has("column_width")) columns->fail("either \"columns\" or \"column_width\"", "both");
    pattern.columns = read_columns(*columns, reader.array("columns"), width);
  } else if (reader.has("column_width")) {
    const double own = zero_or_number(reader, "column_width", width);
    pattern.columns = own > 0.0 ? std::vector<ColumnTier>{{.width = own}} : std::vector<ColumnTier>{};
  }
  pattern.discs_at = read_discs(reader.array("discs_at"), side);
  check_terminations(sets ? *sets : reader.json(), pattern.sets, !pattern.columns.empty());
  if (sets) check_closed(*sets, pattern);
  return pattern;
}

bool has_joint_lengths(JsonReader& reader) {
  if (std::any_of(std::begin(kLengthKeys), std::end(kLengthKeys), [&](const char* key) { return reader.has(key); }))
    return true;
  const auto has_lengths = [](const Json& set) {
    JsonReader of_set(set);
    return std::any_of(std::begin(kSetLengthKeys), std::end(kSetLengthKeys),
                       [&](const char* key) { return of_set.has(key); });
  };
  const Json* sets = reader.child("joint_sets");
  if (sets && sets->type == Json::Type::Object) return has_lengths(*sets);
  const std::vector<Json>& items = reader.array("joint_sets");
  return std::any_of(items.begin(), items.end(), has_lengths);
}

}  // namespace outcrop

// The block types as materials of a strata file, for people to edit.
#include <cmath>

#include "outcrop/amplify/strata_file.h"
#include "outcrop/fracture/orientations.h"

namespace outcrop {
namespace {

// Degrees as people would have written them; types are given so.
double plain_degrees(double angle) {
  constexpr double kDigits = 1e9;
  return std::round(degrees(angle) * kDigits) / kDigits;
}

void write_set(JsonWriter& json, const JointSet& set) {
  constexpr const char* kSpacingLaws[] = {"fixed", "exponential", "lognormal"};
  constexpr const char* kRadiusLaws[] = {"uniform", "power_law", "lognormal"};
  const Orientation orientation = orientation_of(set.normal);
  json.begin_object();
  json.value("name", set.name);
  json.value("dip_deg", plain_degrees(orientation.dip));
  json.value("dip_direction_deg", plain_degrees(orientation.dip_direction));
  json.value("frame", "tile").value("kappa", set.kappa);
  if (set.spacing > 0.0) {
    json.value("spacing", set.spacing);
    json.value("spacing_law", kSpacingLaws[static_cast<std::size_t>(set.spacing_law)]);
    if (set.spacing_law == SpacingLaw::Lognormal) json.value("spacing_cv", set.spacing_cv);
  } else if (set.p32 > 0.0) {
    json.value("p32", set.p32);
  } else {
    json.value("share", set.share);
  }
  if (set.radius_law == RadiusLaw::Persistent) {
    json.value("radius", "persistent");
  } else {
    json.begin_array("radius").item(set.radius_lo).item(set.radius_hi).end_array();
    json.value("radius_law", kRadiusLaws[static_cast<std::size_t>(set.radius_law)]);
  }
  if (!set.ends_at.empty()) {
    json.begin_array("ends_at");
    for (const std::string& name : set.ends_at) json.item(name);
    json.end_array();
  }
  json.end_object();
}

}  // namespace

std::string block_types_json() {
  JsonWriter json;
  json.begin_object();
  json.value("version", 1);
  json.value("description", "The block types in tiles of 20 m. Copy a material, give it a name, change what you like.");
  json.begin_array("materials");
  for (const BlockType type : kBlockTypes) {
    const JointPattern pattern = joint_pattern(type);
    json.begin_object();
    json.value("name", name(type)).value("block_type", name(type)).value("tile_side", kPatternSide);
    json.begin_array("joint_sets");
    for (const JointSet& set : pattern.sets) write_set(json, set);
    json.end_array();
    json.value("discs", pattern.discs);
    json.value("irregular_share", pattern.irregular_share);
    json.value("centre_spacing", pattern.centre_spacing);
    json.value("covered_share", pattern.covered_share);
    json.value("least_thickness", pattern.least_thickness);
    json.value("least_angle_deg", plain_degrees(pattern.least_angle));
    if (!pattern.columns.empty()) {
      json.begin_array("columns");
      for (const ColumnTier& tier : pattern.columns)
        json.begin_object().value("width", tier.width).value("irregularity", tier.irregularity).end_object();
      json.end_array();
    }
    json.end_object();
  }
  json.end_array().end_object();
  return json.text();
}

}  // namespace outcrop

#include "large_fracture_reader.h"

#include <cmath>
#include <string>
#include <vector>

#include "material_reader.h"

namespace outcrop {
namespace {

constexpr Bounds kLength{1.0, 10'000.0};   // Metres.
constexpr Bounds kSpacing{1.0, 100'000.0};
constexpr Bounds kWidth{0.0, 100.0};
constexpr Bounds kMove{-1000.0, 1000.0};   // Steps and slips.
constexpr Bounds kPlace{-1e7, 1e7};

/// The upward normal of a plane that falls by `dip` towards `direction`, clockwise from north; x east, y north.
Vec3 plane_normal(double dip, double direction) {
  return {std::sin(dip) * std::sin(direction), std::sin(dip) * std::cos(direction), std::cos(dip)};
}

LargeFractureSet read_set(const Json& json) {
  JsonReader reader(json);
  (void)reader.string("name", "");
  LargeFractureSet set;
  const double dip = radians(reader.number("dip_deg", 85.0, {0.0, 90.0}));
  set.normal = plane_normal(dip, radians(reader.number("dip_direction_deg", 0.0, {0.0, 360.0})));
  set.kappa = reader.number("kappa", set.kappa, kPositive);
  set.spacing = reader.number("spacing", set.spacing, kSpacing);
  const std::vector<double> length = reader.numbers("length", {set.length_lo, set.length_hi}, 2, kLength);
  if (length[0] > length[1]) reader.child("length")->fail("\"length\": the smallest before the largest");
  set.length_lo = length[0];
  set.length_hi = length[1];
  set.length_exponent = reader.number("length_exponent", set.length_exponent, {0.0, 20.0});
  set.width = reader.number("width", set.width, kWidth);
  set.step = reader.number("step", set.step, kMove);
  set.slip = reader.number("slip", set.slip, kMove);
  if (std::pow(set.length_hi, 3.0) > 1e5 * set.spacing * set.length_lo * set.length_lo)
    json.fail("fractures fewer than some 100000 a cube of the largest length", "a spacing too small for these lengths");
  reader.finish();
  return set;
}

PlacedFracture read_placed(const Json& json) {
  JsonReader reader(json);
  PlacedFracture placed;
  LargeFracture& f = placed.fracture;
  const double dip = radians(reader.number("dip_deg", 90.0, {0.0, 90.0}));
  double direction = radians(reader.number("dip_direction_deg", 0.0, {0.0, 360.0}));
  const Json* trace = reader.child("trace");
  const Json* centre = reader.child("centre");
  if ((trace != nullptr) == (centre != nullptr)) json.fail("a fracture with \"trace\" or \"centre\"", trace ? "both" : "neither");
  if (trace) {
    if (reader.has("length")) reader.child("length")->fail("\"length\" with \"centre\"; a \"trace\" has its own");
    if (reader.has("dip_direction_deg"))
      reader.child("dip_direction_deg")->fail("no \"dip_direction_deg\" with \"trace\": it falls to the trace's right");
    std::vector<Vec2> ends;
    if (trace->type == Json::Type::Array)
      for (const Json& item : trace->items)
        if (item.type == Json::Type::Array && item.items.size() == 2 && item.items[0].type == Json::Type::Number &&
            item.items[1].type == Json::Type::Number)
          ends.emplace_back(item.items[0].number, item.items[1].number);
    if (ends.size() != 2 || trace->items.size() != 2) trace->fail("\"trace\": two points [[x, y], [x, y]]");
    const Vec2 along = ends[1] - ends[0];
    f.radius = 0.5 * glm::length(along);
    if (f.radius < 0.5 * kLength.lo || f.radius > 0.5 * kLength.hi) trace->fail("\"trace\": two points 1 to 10000 m apart");
    f.centre = Vec3(0.5 * (ends[0] + ends[1]), 0.0);
    placed.on_ground = true;
    direction = std::atan2(along.y, -along.x);  // To the right of (x, y) lies (y, −x): clockwise from north.
  } else {
    const std::size_t count = centre->type == Json::Type::Array && centre->items.size() == 3 ? 3 : 2;
    const std::vector<double> at = reader.numbers("centre", {}, count, kPlace);
    placed.on_ground = count == 2;
    f.centre = Vec3(at[0], at[1], count == 3 ? at[2] : 0.0);
    if (!reader.has("length")) json.fail("a fracture with the key \"length\"", "one without");
    f.radius = 0.5 * reader.number("length", 100.0, kLength);
  }
  f.normal = plane_normal(dip, direction);
  f.width = reader.number("width", 2.0, kWidth);
  f.step = reader.number("step", 0.0, kMove);
  f.slip = reader.number("slip", 0.0, kMove);
  reader.finish();
  return placed;
}

}  // namespace

LargeFractureRules read_large_fractures(const Json& json) {
  JsonReader reader(json);
  LargeFractureRules rules;
  for (const Json& set : reader.array("sets")) rules.sets.push_back(read_set(set));
  for (const Json& one : reader.array("placed")) rules.placed.push_back(read_placed(one));
  rules.depth = reader.number("depth", rules.depth, {0.0, 4.0});
  reader.finish();
  return rules;
}

}  // namespace outcrop

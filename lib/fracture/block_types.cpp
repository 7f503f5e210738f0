// The named types of rock: each a list of joint sets.
#include <cmath>

#include "outcrop/core/error.h"
#include "outcrop/fracture/joints.h"
#include "outcrop/fracture/orientations.h"

namespace outcrop {
namespace {

// By dip and dip direction in degrees, as files give them.
Vec3 normal_at(double dip_deg, double dip_direction_deg) {
  return normal_of({radians(dip_deg), radians(dip_direction_deg)});
}

JointSet joint_set(const char* name, const Vec3& normal, double kappa, double share, double radius_lo,
                   double radius_hi) {
  return {.name = name,
          .normal = normal,
          .kappa = kappa,
          .share = share,
          .radius_lo = radius_lo,
          .radius_hi = radius_hi};
}

// Numbers of discs and centre spacings are those of Paris et al. 2020, section 4.1 and Table 1. Radii are as there for
// bedding, about as there for polyhedral rock, and up to twice as long elsewhere: our joints end at others, and with 15
// discs of 5 m there would be 60 blocks, not 125. Concentrations and stress shadows are ours: see
// docs/decisions/fracture.md.
JointPattern pattern_at_20_m(BlockType type) {
  const Vec3 x = normal_at(90, 90);
  const Vec3 y = normal_at(90, 0);
  const Vec3 z = normal_at(0, 0);
  switch (type) {
    case BlockType::Equidimensional:
      return {.sets = {joint_set("across x", x, 200, 1, 8, 12), joint_set("across y", y, 200, 1, 8, 12),
                       joint_set("level", z, 200, 1, 8, 12)},
              .discs = 15,
              .irregular_share = 0.1,
              .least_thickness = 1.8};
    case BlockType::Rhombohedral:
      // At 65° to each other about the cube's diagonal; at 60° these were the diagonals (0 1 1), (1 0 1), (1 1 0).
      return {.sets = {joint_set("oblique 1", normal_at(45.08, 355.64), 250, 1, 5, 7),
                       joint_set("oblique 2", normal_at(45.08, 94.36), 250, 1, 5, 7),
                       joint_set("oblique 3", normal_at(86.92, 225.00), 250, 1, 5, 7)},
              .discs = 24,
              .least_thickness = 2.0};
    case BlockType::Polyhedral:
      return {.sets = {joint_set("irregular", z, 1, 1, 3, 4)},  // κ does not matter: all are irregular
              .discs = 44,
              .irregular_share = 1.0,
              .centre_spacing = 1.0,
              .least_thickness = 1.6,
              .least_angle = radians(35.0)};
    case BlockType::Tabular:
      return {.sets = {joint_set("bedding", z, 600, 2, 20, 20), joint_set("across x", x, 80, 1, 2.8, 4),
                       joint_set("across y", y, 80, 1, 2.8, 4)},
              .discs = 30,
              .least_thickness = 0.8};
    case BlockType::Columnar:
      return {.sets = {{.name = "cross joints",
                        .normal = z,
                        .kappa = 150,
                        .spacing = 8,
                        .spacing_law = SpacingLaw::Lognormal,
                        .spacing_cv = 0.4,
                        .radius_law = RadiusLaw::Persistent,
                        .ends_at = {std::string(kColumns)}}},
              .discs = 0,
              .columns = {{.width = 2.4}},
              .least_thickness = 1.6};
    case BlockType::Prismatic:
      return {.sets = {joint_set("across x", x, 60, 1, 6.5, 9), joint_set("across y", y, 60, 1, 6.5, 9),
                       joint_set("cross joints", z, 60, 0.4, 3, 5)},
              .discs = 18,
              .least_thickness = 1.6};
  }
  return {};
}

}  // namespace

std::string_view name(BlockType type) noexcept {
  switch (type) {
    case BlockType::Equidimensional:
      return "equidimensional";
    case BlockType::Rhombohedral:
      return "rhombohedral";
    case BlockType::Polyhedral:
      return "polyhedral";
    case BlockType::Tabular:
      return "tabular";
    case BlockType::Columnar:
      return "columnar";
    case BlockType::Prismatic:
      return "prismatic";
  }
  return "unknown";
}

JointPattern joint_pattern(BlockType type, double side) {
  require(std::isfinite(side) && side > 0.0, "side", "> 0 and finite", side);
  return scaled(pattern_at_20_m(type), side / kPatternSide);
}

JointPattern scaled(JointPattern pattern, double factor) {
  for (JointSet& set : pattern.sets) {
    set.spacing *= factor;
    set.p32 /= factor;
    set.radius_lo *= factor;
    set.radius_hi *= factor;
    set.radius_mean *= factor;
  }
  for (ColumnTier& tier : pattern.columns) tier.width *= factor;
  for (Disc& disc : pattern.discs_at) {
    disc.centre *= factor;
    disc.radius *= factor;
  }
  pattern.centre_spacing *= factor;
  pattern.least_thickness *= factor;
  return pattern;
}

}  // namespace outcrop

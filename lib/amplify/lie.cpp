#include "lie.h"

#include <cmath>
#include <utility>

namespace outcrop {

Lie lie_of(const StrataFile& file) {
  const double azimuth = file.placement.lattice_azimuth;
  const Mat3 turn(Vec3(std::cos(azimuth), std::sin(azimuth), 0.0), Vec3(-std::sin(azimuth), std::cos(azimuth), 0.0),
                  Vec3(0.0, 0.0, 1.0));
  return {file.strata.world_from_bedding(), turn};
}

TileOptions tile_options(const RockMaterial& material, double default_side, const Lie& lie) {
  TileOptions options = tile_options(material, default_side);
  const Mat3 tile_from_bedding = glm::transpose(lie.bedding_from_tile);
  options.pattern = in_tile_frame(std::move(options.pattern), JointFrame::Bedding, tile_from_bedding);
  options.pattern = in_tile_frame(std::move(options.pattern), JointFrame::Map,
                                  tile_from_bedding * glm::transpose(lie.world_from_bedding));
  return options;
}

}  // namespace outcrop

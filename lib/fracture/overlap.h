/// How often blocks of a tile cover each other.
#pragma once

#include <cstddef>

#include "outcrop/fracture/tile.h"

namespace outcrop {

/// The share of `probes` random points of the torus that lie in two blocks or more (or twice in one that wraps).
[[nodiscard]] double overlap_share(const Tile& tile, std::size_t probes, Seed seed);

}  // namespace outcrop

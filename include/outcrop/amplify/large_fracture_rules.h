/// Master joints and faults as strata.json asks for them.
#pragma once

#include <vector>

#include "outcrop/terrain/heightfield.h"
#include "outcrop/terrain/strata.h"
#include "outcrop/tiles/large_fractures.h"

namespace outcrop {

/// One that was drawn by hand: positions relative to the terrain's south-west corner.
struct PlacedFracture {
  LargeFracture fracture;
  bool on_ground = false;  ///< The centre's elevation is the ground's.
};

struct LargeFractureRules {
  std::vector<LargeFractureSet> sets;
  std::vector<PlacedFracture> placed;
  double depth = 1.3;  ///< Of gaps behind the surface, in withdrawals of the ground behind its blocks, [0, 4].

  [[nodiscard]] bool empty() const noexcept { return sets.empty() && placed.empty(); }
};

/// The fractures that reach into a region, in map coordinates: those of the sets the same whatever the region.
[[nodiscard]] std::vector<LargeFracture> large_fractures_on(const LargeFractureRules& rules, const Heightfield& heightfield,
                                                            const Box& region, Seed seed);

/// Those along which rock has slipped, for the strata to be displaced by: the largest slips, at most so many.
[[nodiscard]] std::vector<Fault> faults_of(const std::vector<LargeFracture>& fractures, std::size_t most);

}  // namespace outcrop

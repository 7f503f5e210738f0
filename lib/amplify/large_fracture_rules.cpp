#include "outcrop/amplify/large_fracture_rules.h"

#include <algorithm>
#include <cmath>

namespace outcrop {

std::vector<LargeFracture> large_fractures_on(const LargeFractureRules& rules, const Heightfield& heightfield,
                                              const Box& region, Seed seed) {
  const Vec3 corner(heightfield.lo(), 0.0);
  std::vector<LargeFracture> fractures;
  for (const PlacedFracture& placed : rules.placed) {
    LargeFracture f = placed.fracture;
    f.centre += corner;
    if (placed.on_ground) f.centre.z = heightfield.at(f.centre.x, f.centre.y).h;
    fractures.push_back(f);
  }
  for (std::size_t s = 0; s < rules.sets.size(); ++s) {
    const std::vector<LargeFracture> drawn = draw_large_fractures(rules.sets[s], region, corner, seed, s);
    fractures.insert(fractures.end(), drawn.begin(), drawn.end());
  }
  return fractures;
}

std::vector<Fault> faults_of(const std::vector<LargeFracture>& fractures, std::size_t most) {
  std::vector<Fault> faults;
  for (const LargeFracture& f : fractures) {
    if (f.slip == 0.0) continue;
    const double dip = std::acos(std::clamp(f.normal.z, 0.0, 1.0));
    double direction = std::atan2(f.normal.x, f.normal.y);
    if (direction < 0.0) direction += 2.0 * kPi;
    // What slips more than half its radius would fold space over.
    const double slip = std::clamp(f.slip, -0.5 * f.radius, 0.5 * f.radius);
    faults.push_back({.point = f.centre, .dip = dip, .dip_direction = direction, .slip = slip, .extent = f.radius});
  }
  std::ranges::stable_sort(faults, [](const Fault& a, const Fault& b) { return std::abs(a.slip) > std::abs(b.slip); });
  if (faults.size() > most) faults.resize(most);
  return faults;
}

}  // namespace outcrop

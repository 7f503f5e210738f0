#include "sheets.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "joint_laws.h"

namespace outcrop {
namespace {

/// Two walls of a region that are one joint, met again after a pitch.
struct ClosingWalls {
  Vec3 axis{0.0};
  double first = 0.0;  ///< Of the first wall along the axis.
  double pitch = 0.0;
};

std::optional<ClosingWalls> closing_walls(const std::vector<Region::Wall>& walls, const std::vector<Disc>& discs,
                                          int set) {
  for (std::size_t i = 0; i + 1 < walls.size(); ++i) {
    const auto& [floor, joint] = walls[i];
    if (joint < 0 || joint != walls[i + 1].joint || discs[static_cast<std::size_t>(joint)].set != set) continue;
    return ClosingWalls{-floor.normal, floor.offset, -floor.offset - walls[i + 1].plane.offset};
  }
  return std::nullopt;
}

}  // namespace

SheetSource::SheetSource(std::vector<Disc>& discs, const ClusterOptions& options, Seed seed)
    : discs_(discs), options_(options), seed_(seed), ages_(joint_ages(options.sets)) {}

void SheetSource::enter(const Region& region, const Polytope& shape) {
  ++region_;
  made_.clear();
  walls_ = region.walls;
  layered_sets_ = region.layered_sets;
  middle_ = shape.middle();
  reach_ = 0.0;
  for (const Vec3& v : shape.vertices) reach_ = std::max(reach_, glm::distance(v, middle_));
}

std::vector<int> SheetSource::crossing(std::size_t set, std::uint64_t compartment, double share, const Box& box) {
  if (std::find(layered_sets_.begin(), layered_sets_.end(), static_cast<int>(set)) != layered_sets_.end()) return {};
  const auto [it, is_new] = made_.try_emplace({set, compartment});
  if (is_new) it->second = sheets(set, compartment, share);
  std::vector<int> result;
  for (Sheet& sheet : it->second) {
    if (!crosses(sheet.plane, box)) continue;
    if (sheet.disc < 0) {
      sheet.disc = static_cast<int>(discs_.size());
      discs_.push_back({.centre = sheet.centre,
                        .radius = kPersistentRadius * options_.side,
                        .normal = sheet.plane.normal,
                        .set = static_cast<int>(set),
                        .age = ages_[set]});
    }
    result.push_back(sheet.disc);
  }
  return result;
}

// Between the two walls that are one joint of the set, the gaps add up to their distance. Elsewhere the sequence is cut
// out of an endless one, along each joint's own normal: with exponential gaps these are planes at random.
std::vector<SheetSource::Sheet> SheetSource::sheets(std::size_t s, std::uint64_t compartment, double share) const {
  const JointSet& set = options_.sets[s];
  const auto walls = closing_walls(walls_, discs_, static_cast<int>(s));
  Rng rng(seed_ ^ compartment, "sheets", std::uint64_t{s} << 32 | region_);
  const GapRule rule{.least = 2.0 * options_.min_inradius,
                     .periods = options_.columns.empty() ? GapRule::Periods::One : GapRule::Periods::Many};
  const std::vector<double> positions =
      walls ? closed_positions(set, walls->pitch, rule, true, rng) : open_positions(set, reach_, rule, rng);
  std::vector<Sheet> result;
  for (const double t : positions) {
    const Vec3 normal = draw_normal(set, rng);
    const bool chosen = rng.uniform() < share;
    if (!chosen || (walls && t == 0.0)) continue;
    Sheet sheet;
    sheet.centre = walls ? middle_ + (walls->first + t - glm::dot(walls->axis, middle_)) * walls->axis
                         : middle_ + t * normal;
    sheet.plane = {normal, -glm::dot(normal, sheet.centre)};
    result.push_back(sheet);
  }
  return result;
}

}  // namespace outcrop

/// Persistent joints of a region: sheets at distances by their set's law, anew in each compartment that they end in.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "region.h"

namespace outcrop {

/// Makes the sheets of one region after the other, in the region's coordinates.
class SheetSource {
 public:
  /// @param discs  Sheets that are used join them.
  SheetSource(std::vector<Disc>& discs, const ClusterOptions& options, Seed seed);

  /// Turns to another region. @param shape  What its walls bound.
  void enter(const Region& region, const Polytope& shape);

  /// The discs of the set's sheets in a compartment that cross a box, in the order of their places. The same compartment
  /// has the same sheets.
  /// @param share  Which part of the set's joints is meant.
  [[nodiscard]] std::vector<int> crossing(std::size_t set, std::uint64_t compartment, double share, const Box& box);

 private:
  struct Sheet {
    Plane plane;
    Vec3 centre;
    int disc = -1;  ///< Once it is used.
  };
  [[nodiscard]] std::vector<Sheet> sheets(std::size_t set, std::uint64_t compartment, double share) const;

  std::vector<Disc>& discs_;
  const ClusterOptions& options_;
  Seed seed_;
  std::vector<int> ages_;
  std::uint64_t region_ = 0;  ///< How many there were.
  Vec3 middle_{0.0};
  double reach_ = 0.0;  ///< From the middle to the farthest corner.
  std::vector<Region::Wall> walls_;
  std::vector<int> layered_sets_;
  std::map<std::pair<std::size_t, std::uint64_t>, std::vector<Sheet>> made_;
};

/// Whether a plane crosses a box.
[[nodiscard]] inline bool crosses(const Plane& plane, const Box& box) {
  const Vec3 half = 0.5 * box.size();
  const double reach = glm::dot(glm::abs(plane.normal), half);
  return std::abs(plane.distance(box.lo + half)) < reach;
}

}  // namespace outcrop

/// Pieces of the torus that still wrap around it, and the joints that close them.
#pragma once

#include <cstdint>
#include <vector>

#include "outcrop/fracture/clusters.h"

namespace outcrop {

/// The tile's lattice is side · Z³. A region is convex in space and repeats by its periods: three (the whole torus),
/// two (a slab), one (a rod) or none (a cell). Its samples are moved by whole tiles to lie in it, up to its periods.
struct Region {
  struct Wall {
    Plane plane;
    int joint;
  };
  std::vector<Wall> walls;
  std::vector<IVec3> periods;
  std::vector<std::uint32_t> samples;
  std::vector<Vec3> positions;
  std::vector<int> spent;  ///< Discs that are walls already.
};

/// Cuts the torus until nothing wraps: regions without periods, in a fixed order.
class RegionSplitter {
 public:
  RegionSplitter(const std::vector<Disc>& discs, const ClusterOptions& options, Seed seed);

  [[nodiscard]] std::vector<Region> run(const std::vector<Vec3>& samples);

  [[nodiscard]] std::size_t added_joints() const noexcept { return added_joints_; }
  [[nodiscard]] double largest_bend() const noexcept { return largest_bend_; }

 private:
  /// A plane that closes a region: n · (x − centre) = 0, met again after `step` tiles.
  struct Closing {
    Vec3 normal{0.0};
    Vec3 centre{0.0};
    IVec3 step{0};
    std::vector<IVec3> periods;
    int joint = kAddedJoint;
    double bend = 0.0;
  };

  [[nodiscard]] Closing torus_closing();
  [[nodiscard]] Closing slab_closing(const Region& slab);
  [[nodiscard]] Closing rod_closing(const Region& rod);
  [[nodiscard]] Region close(Region region, const Closing& closing);
  [[nodiscard]] std::vector<Region> bedded(Region slab);
  [[nodiscard]] bool is_spent(const Region& region, int disc) const;
  [[nodiscard]] Rng added_stream() { return Rng(seed_, "added joints", added_joints_++); }

  const std::vector<Disc>& discs_;
  const ClusterOptions& options_;
  Seed seed_;
  std::size_t added_joints_ = 0;
  double largest_bend_ = 0.0;
};

/// Columns along z: the Voronoi cells of evenly spread seeds in the plane, as rods that repeat by one tile along z.
[[nodiscard]] std::vector<Region> column_regions(const std::vector<Vec3>& samples, double side, double width,
                                                 Seed seed);

}  // namespace outcrop

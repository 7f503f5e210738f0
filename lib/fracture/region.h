/// Pieces of the torus that still wrap around it, and the joints that close them.
#pragma once

#include <cstdint>
#include <utility>
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
  std::vector<int> spent;         ///< Discs that are walls already.
  std::vector<int> layered_sets;  ///< Persistent sets all of whose joints are walls of layers already.
  IVec3 axis{0};                  ///< Of a cell: the period of the rod that it was cut from.
};

/// Cuts the torus until nothing wraps: regions without periods, in a fixed order.
class RegionSplitter {
 public:
  /// @param discs  Those drawn; persistent joints that become walls are added.
  RegionSplitter(std::vector<Disc>& discs, const ClusterOptions& options, Seed seed);

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
    int joint = kAddedJoint;  ///< A disc, or a closer until it is taken.
    double bend = 0.0;
  };
  /// How a candidate for a closing is called: the disc's index, or −10 − the set of a persistent joint.
  static constexpr int kFirstCloser = -10;

  [[nodiscard]] Closing torus_closing();
  [[nodiscard]] Closing slab_closing(const Region& slab);
  [[nodiscard]] Closing rod_closing(const Region& rod);
  [[nodiscard]] Region close(Region region, const Closing& closing);
  [[nodiscard]] std::vector<Region> bedded(Region slab);
  [[nodiscard]] std::vector<Region> layers(Region slab, std::vector<std::pair<double, int>> beds);
  [[nodiscard]] bool is_spent(const Region& region, int disc) const;
  [[nodiscard]] const Disc& candidate(int i) const;
  [[nodiscard]] Disc draw_closer(std::size_t set);
  [[nodiscard]] int take(int i);
  [[nodiscard]] bool others_end_at(std::size_t set) const;
  [[nodiscard]] Rng added_stream() { return Rng(seed_, "added joints", added_joints_++); }

  std::vector<Disc>& discs_;
  const ClusterOptions& options_;
  Seed seed_;
  std::vector<Disc> closers_;    ///< One a set, waiting to close a region; of no use where the set is not persistent.
  std::vector<int> candidates_;  ///< For closings: the discs that may be turned, and the closers.
  std::size_t drawn_closers_ = 0;
  std::size_t added_joints_ = 0;
  double largest_bend_ = 0.0;
};

/// Columns along z: the Voronoi cells of seeds in the plane, as rods that repeat by one tile along z; several tiers: as
/// cells between the joints at which they meet.
/// @param boxed  Seeds do not see each other around the tile: flat joints bound its columns along x and y, so that any two
///               tiles of columns fit side by side.
[[nodiscard]] std::vector<Region> column_regions(const std::vector<Vec3>& samples, double side,
                                                 const std::vector<ColumnTier>& tiers, bool boxed, Seed seed);

}  // namespace outcrop

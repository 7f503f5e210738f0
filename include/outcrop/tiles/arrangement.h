/// Where the copies of a tile's regions stand.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/fracture/tile.h"

namespace outcrop {

/// The copies of a tile's regions that may reach into a domain: an infinite arrangement, of which only the rods of the
/// domain are written down.
///
/// A copy is numbered along its rod, by its rod, and by its layer, from the base copies (0, 0, 0), (0, 0, 1), …: where it
/// stands and what it holds are functions of these numbers and the layout's seed alone, whatever the domain. Each wall
/// stands 8 % of the distance between walls before or behind its place in the lattice, and the blocks between two are
/// stretched along with them; layers that lie on each other are turned against each other by some degrees instead of having
/// rods of different thickness.
class Arrangement {
 public:
  struct Copy {
    IVec3 id;
    std::size_t list;  ///< Which blocks: see blocks().
    Vec3 origin;       ///< They stand at origin + Block::home.
  };

  Arrangement() = default;
  /// @param reach   Metres beyond their planes by which blocks matter, ≥ 0.
  /// @param domain  Tile frame, not empty.
  /// @throws ParameterError for a domain more than 2^20 tiles away.
  Arrangement(const Tile& tile, double reach, const Box& domain);

  /// Lists of blocks: one for each variant and layer, and when the layout slides, for each of 27 ways to stretch it.
  [[nodiscard]] std::size_t list_count() const noexcept;
  /// The blocks of a list. @param tile  As given to the constructor.
  [[nodiscard]] std::vector<Block> blocks(const Tile& tile, std::size_t list) const;

  /// Numbers of the domain's copies: `visit` gives indices below it.
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// The index of a copy, or size() where the domain does not have it.
  [[nodiscard]] std::size_t index(const IVec3& id) const noexcept;

  /// Calls visit(index, copy) for each copy of the domain that may reach into the box (tile frame), in a fixed order,
  /// until it answers false. Cost: O(log layers), and some 100 ns a copy.
  template <class Visit>
  void visit(const Box& box, Visit&& visit) const;

 private:
  /// A layer of the layout as it lies when turned: its walls n · x = offset, and how far beyond the first of each two its
  /// blocks reach.
  struct Frame {
    std::array<Vec3, 3> normals;     ///< Of floors, of the walls between rods, of ends; unit.
    Vec3 offsets{0.0};               ///< Of the base copy's first walls.
    std::array<Interval, 3> reaches;
    std::array<Vec3, 3> edges;       ///< The dual basis: a step along one of them crosses the walls of one kind.
    Vec3 across{0.0};                ///< Unit; in the layer, at right angles to the rods.
    Vec3 axis{0.0};                  ///< Of the rods, unit.
    double rod_step = 0.0;           ///< Metres along `across` from rod to rod; may be negative.
    double copy_step = 0.0;          ///< Along the ends' normal from copy to copy.
  };
  struct Rod {
    Vec3 origin;     ///< Of copy 0, as it stands in the lattice.
    Interval reach;  ///< Along the normal of the walls between rods.
    int size;        ///< Number of its thickness.
  };
  /// One layer of one slab.
  struct PlacedLayer {
    std::size_t layer;  ///< Of the layout.
    std::size_t frame;
    int id;
    double floor;       ///< Along the normal.
    Interval reach;     ///< The same.
    int size;           ///< Number of its thickness.
    Interval rod_reach;  ///< Of rod r, along the normal of the walls between rods, from r · side_pitch: at most.
    int first_rod, first_copy, copies;
    std::vector<Rod> rods;
    std::size_t first;  ///< Index of the first copy of the first rod.
  };

  [[nodiscard]] static Interval along(const Box& box, const Vec3& direction) noexcept;
  /// Where wall `number` stands in the lattice of walls; size_of: of what lies between it and the next, 0 to 2.
  [[nodiscard]] double wall(std::string_view of, std::uint64_t in, int number) const noexcept;
  [[nodiscard]] int size_of(std::string_view of, std::uint64_t in, int number) const noexcept;
  [[nodiscard]] bool moved_on(std::string_view of, std::uint64_t in, int number) const noexcept;
  /// Where copy 0 of a rod may reach, along the ends' normal.
  [[nodiscard]] Interval copy_reach(const Frame& frame, const Rod& rod) const noexcept;
  [[nodiscard]] Copy copy_of(const PlacedLayer& placed, std::size_t rod, int number) const noexcept;
  void add_frame(const Tile& tile, std::size_t layer, double turn, double reach);
  /// The layers of a slab in their order.
  void add_slab(int slab, const Box& domain);

  TileLayout layout_;
  std::size_t variants_ = 1;
  std::vector<Frame> frames_;        ///< Of each layer of the layout, as often as there are turns.
  std::vector<PlacedLayer> layers_;  ///< From the lowest to the highest.
  Interval overhang_{0.0, 0.0};      ///< How far blocks reach above their layer's floor.
  std::size_t size_ = 0;
};

template <class Visit>
void Arrangement::visit(const Box& box, Visit&& visit) const {
  const Interval up = along(box, layout_.normal);
  auto placed = std::lower_bound(layers_.begin(), layers_.end(), up.lo - overhang_.hi,
                                 [](const PlacedLayer& p, double floor) { return p.floor < floor; });
  for (; placed != layers_.end() && placed->floor + overhang_.lo <= up.hi; ++placed) {
    if (placed->reach.lo > up.hi || placed->reach.hi < up.lo) continue;
    const TileLayout::Layer& layer = layout_.layers[placed->layer];
    const Frame& frame = frames_[placed->frame];
    const Interval aside = along(box, frame.normals[1]);
    const Interval axial = along(box, frame.normals[2]);
    // In doubles first: a box may be far away.
    const double first_rod = std::ceil((aside.lo - placed->rod_reach.hi) / layer.side_pitch) - placed->first_rod;
    const double last_rod = std::floor((aside.hi - placed->rod_reach.lo) / layer.side_pitch) - placed->first_rod;
    for (double r = std::max(first_rod, 0.0); r <= std::min(last_rod, static_cast<double>(placed->rods.size()) - 1.0); ++r) {
      const auto row = static_cast<std::size_t>(r);
      const Rod& rod = placed->rods[row];
      if (rod.reach.lo > aside.hi || rod.reach.hi < aside.lo) continue;
      const Interval ends = copy_reach(frame, rod);
      const double first = std::max(std::ceil((axial.lo - ends.hi) / frame.copy_step), static_cast<double>(placed->first_copy));
      const double last = std::min(std::floor((axial.hi - ends.lo) / frame.copy_step),
                                   static_cast<double>(placed->first_copy + placed->copies - 1));
      for (double c = first; c <= last; ++c) {
        const int k = static_cast<int>(c);
        const std::size_t index = placed->first + row * static_cast<std::size_t>(placed->copies) +
                                  static_cast<std::size_t>(k - placed->first_copy);
        if (!visit(index, copy_of(*placed, row, k))) return;
      }
    }
  }
}

}  // namespace outcrop

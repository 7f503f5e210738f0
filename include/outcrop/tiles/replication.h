/// The replication node: the blocks of one tile, repeated over space where presence says so.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "outcrop/core/task.h"
#include "outcrop/fracture/tile.h"
#include "outcrop/implicit/field.h"
#include "outcrop/implicit/rounded_polytope.h"
#include "outcrop/tiles/arrangement.h"
#include "outcrop/tiles/presence.h"

namespace outcrop {

class PlacedBlocks;

/// A tile and how it stands in the world: p_world = origin + world_from_tile · p_tile; its layout says where copies are.
struct Rock {
  Tile tile;
  Warp warp;                    ///< The relief's period should divide the tile's side.
  Label label = 0;
  Mat3 world_from_tile{1.0};    ///< A rotation.
  Vec3 origin{0.0};             ///< World position of a corner of cell (0, 0, 0).
};

/// Where the blocks stand and how their cracks close.
struct ReplicationOptions {
  Box domain;                   ///< World; blocks are placed when they may matter inside.
  Criterion criterion;          ///< Asked of every block's anchors; null: every block is present.
  FieldPtr body;                ///< Negative where this rock's material stands: anchors elsewhere do not count, and of
                                ///< blocks that reach in without any, all count. Null: everywhere.
  Weight weight;                ///< Drops blocks by size where it is below 1 (drop_threshold); null: 1.
  Seed seed = 1;                ///< Of the chance in that.
  std::function<double(const Vec3&)> slope;    ///< Steepness at an anchor, radians; null: from the terrain's gradient there.
  std::function<bool(const Box&)> visible;     ///< False: nothing in this box can be seen, no block is placed there; null: true.
  FieldPtr crack_floor;         ///< Below this surface cracks close; null: they stay open.
  double closure = 0.0;         ///< Metres by which blocks grow below the crack floor, ≥ 0.
  double closure_slope = 0.05;  ///< Growth per metre below the crack floor, > 0.
  double swelling = 0.0;        ///< Metres by which blocks grow everywhere, to weld cracks that a mesh could not resolve.
  double min_inradius = 0.0;    ///< Blocks with a smaller inner ball are not placed.
  double cap = 0.4;             ///< The field's largest value, metres, > 0: away from blocks it is this constant.
};

/// t(p) = min(cap, min over present blocks of b_i(p) − swelling − growth(p)), growth in [0, closure] below the crack floor.
///
/// A block that is missing is not evaluated. Presence is decided once a (copy, block), when the node is built, and held as
/// one bit each. Memory: 4 bytes a copy of a region in the domain, a bit a block in copies with blocks, and the shapes of the
/// lists of blocks in use: one list without variants, else at most 25 a variant. Cost of a value: the one to three copies
/// that reach the point, the boxes of their blocks, and the one to three blocks whose boxes hold it.
/// Method: Paris et al. 2020, section 5, with the sign and the presence of docs/decisions/placement.md.
class Replication final : public Field {
 public:
  /// @param terrain  Negative in rock; its values, gradients and labels feed the presence criterion.
  /// @throws ParameterError; Cancelled.
  Replication(Rock rock, FieldPtr terrain, ReplicationOptions options, const Task& task = {});

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override;
  [[nodiscard]] double lipschitz() const noexcept override;
  [[nodiscard]] Modulus modulus() const noexcept override;
  [[nodiscard]] Interval bound(const Box& box) const noexcept override;
  [[nodiscard]] FieldPtr narrow(const Box& box) const override;
  void labels(const Points& points, std::span<Label> labels) const noexcept override;

  /// Blocks present.
  [[nodiscard]] std::size_t block_count() const noexcept { return block_count_; }
  /// Is block `block` of the copy's list present? In a lattice a copy is a cell, and the list the tile's blocks.
  [[nodiscard]] bool block_present(const IVec3& copy, std::size_t block) const noexcept;
  /// Bytes of the blocks' field functions, in all lists in use.
  [[nodiscard]] std::size_t tile_bytes() const noexcept;

 private:
  friend class PlacedBlocks;
  struct Shape {
    PolytopeKernel kernel;
    Vec3 centre;   ///< In the base copy.
    Box support;   ///< Relative to the centre; outside it the block's value is at least `cap`.
    Box world;     ///< Of the polytope, world axes, relative to the world position of the centre.
    double inradius;
    double size_rank = 0.0;  ///< Share of the tile's blocks that are larger.
  };
  /// A list of the arrangement: a run of shapes.
  struct List {
    std::uint32_t first = 0, count = 0;
    Box support;  ///< Around the blocks' supports, in the base copy.
  };

  [[nodiscard]] Vec3 to_tile(const Vec3& world) const noexcept { return tile_from_world_ * (world - rock_.origin); }
  [[nodiscard]] Box to_tile(const Box& world) const noexcept;
  /// The box itself, turned.
  [[nodiscard]] TurnedBox turned(const Box& world) const noexcept;
  /// The present blocks of a box, at most so many; null when there are more.
  [[nodiscard]] std::shared_ptr<const PlacedBlocks> blocks_in(const Box& box, std::size_t most) const;
  /// Makes the shapes of the lists that are used, and returns the block of each. @param reach  Metres beyond its planes at
  /// which a block's value may be below the cap.
  [[nodiscard]] std::vector<Block> make_shapes(double reach, const std::vector<char>& used);
  void place_blocks(const Field& terrain, double reach, const Task& task);
  [[nodiscard]] std::vector<std::uint64_t> present_blocks(const Arrangement::Copy& copy, const Field& terrain,
                                                          const std::vector<Block>& blocks) const;
  /// How a block at a world position lies in the body.
  enum class Reach { None, Part, Whole };
  [[nodiscard]] Reach reach_into_body(const Block& block, const Vec3& world_centre) const;
  /// Of a copy of the list's block: see outcrop::drop_threshold.
  [[nodiscard]] double drop_threshold(const IVec3& copy, std::size_t block, double size_rank) const;
  /// One bit a block that is present in the copy; null where none is.
  [[nodiscard]] const std::uint64_t* presence(std::size_t copy) const noexcept {
    const std::uint32_t first = presence_of_[copy];
    return first == 0 ? nullptr : &presence_[first];
  }
  /// Calls visit(block, position) for each present block whose support overlaps the box, once each, until it answers
  /// false.
  template <class Visit>
  void visit_blocks(const Box& tile_box, Visit&& visit) const;
  /// Is the box larger than most blocks? Then it holds rock and air, and nobody looks at planes.
  [[nodiscard]] bool large(const Box& box) const noexcept { return box.half_diagonal() > half_block_; }

  Rock rock_;
  ReplicationOptions options_;
  Mat3 tile_from_world_;
  std::vector<Shape> shapes_;
  std::vector<List> lists_;  ///< The arrangement's; those that nobody uses are empty.
  Arrangement arrangement_;
  std::vector<std::uint32_t> presence_of_;   ///< Where a copy's words begin; 0: no block is present.
  std::vector<std::uint64_t> presence_{0};   ///< One bit a block.
  std::size_t block_count_ = 0;
  std::vector<Box> supports_in_tile_;  ///< Of each shape, in the base copy.
  double lipschitz_ = 1.0;
  double half_block_ = 0.0;  ///< Mean half diagonal of a block's box.
  double deepest_ = 0.0;  ///< No value is below − deepest_.
};

}  // namespace outcrop

#include "outcrop/tiles/arrangement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "outcrop/core/error.h"

namespace outcrop {
namespace {

constexpr double kSide = 20.0;

// Tiles without cracks, coarsely sampled, made once.
const Tile& tile_of(BlockType type, int variants) {
  static std::map<std::pair<BlockType, int>, Tile> tiles;
  const auto [it, is_new] = tiles.try_emplace({type, variants});
  if (is_new)
    it->second = make_tile({.type = type, .side = kSide, .spacing = 1.0, .aperture = 0.0, .variants = variants}, 5);
  return it->second;
}

// How many blocks hold a point, those that only touch it left out.
int covers(const std::vector<std::vector<Block>>& lists, const Arrangement& arrangement, const Vec3& p) {
  int count = 0;
  arrangement.visit({p, p}, [&](std::size_t, const Arrangement::Copy& copy) {
    for (const Block& block : lists[copy.list]) {
      const Vec3 local = p - (copy.origin + block.home);
      count += std::all_of(block.planes.begin(), block.planes.end(),
                           [&](const Plane& plane) { return plane.distance(local) < 0.0; });
    }
    return true;
  });
  return count;
}

Vec3 point_in(const Box& box, Rng& rng) {
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = rng.uniform(box.lo[axis], box.hi[axis]);
  return p;
}

const Box kDomain{{-70.0, -50.0, -60.0}, {80.0, 90.0, 70.0}};

TEST(Arrangement, FillsSpaceOnceWithVariantsOfEveryType) {
  for (const BlockType type : kBlockTypes)
    for (const int variants : {1, 4}) {
      SCOPED_TRACE(std::string(name(type)) + ", variants " + std::to_string(variants));
      const Tile& tile = tile_of(type, variants);
      const Arrangement arrangement(tile, 0.0, kDomain);
      std::vector<std::vector<Block>> lists;
      for (std::size_t i = 0; i < arrangement.list_count(); ++i) lists.push_back(arrangement.blocks(tile, i));
      Rng rng(1, "arrangement test");
      for (int i = 0; i < 2000; ++i) ASSERT_EQ(covers(lists, arrangement, point_in(kDomain, rng)), 1);
    }
}

TEST(Arrangement, FillsSpaceOnceWithPersistentBedsAndTiersOfColumns) {
  const JointSet beds{.name = "beds", .kappa = 400.0, .spacing = 3.0, .radius_law = RadiusLaw::Persistent};
  const JointSet cross{.name = "cross", .normal = {0.8, 0.6, 0.0}, .spacing = 4.0, .radius_law = RadiusLaw::Persistent, .ends_at = {"beds"}};
  const JointSet other{.name = "other", .normal = {-0.6, 0.8, 0.0}, .spacing = 5.0, .radius_law = RadiusLaw::Persistent, .ends_at = {"beds"}};
  const JointPattern bedded{.sets = {beds, cross, other}, .discs = 0};
  JointPattern tiers = joint_pattern(BlockType::Columnar, kSide);
  tiers.columns = {{.width = 3.0, .irregularity = 0.2}, {.width = 2.0, .irregularity = 0.8}};
  for (const JointPattern& pattern : {bedded, tiers}) {
    const Tile tile = make_tile({.pattern = pattern, .side = kSide, .spacing = 1.0, .aperture = 0.0, .variants = 3}, 2);
    const Arrangement arrangement(tile, 0.0, kDomain);
    std::vector<std::vector<Block>> lists;
    for (std::size_t i = 0; i < arrangement.list_count(); ++i) lists.push_back(arrangement.blocks(tile, i));
    Rng rng(1, "arrangement test");
    for (int i = 0; i < 1000; ++i) ASSERT_EQ(covers(lists, arrangement, point_in(kDomain, rng)), 1);
  }
}

TEST(Arrangement, OfOneVariantIsTheTilesLattice) {
  const Tile& tile = tile_of(BlockType::Tabular, 1);
  const Arrangement arrangement(tile, 0.0, kDomain);
  arrangement.visit(kDomain, [&](std::size_t, const Arrangement::Copy& copy) {
    EXPECT_EQ(copy.list, 0u);
    EXPECT_EQ(copy.origin, kSide * Vec3(copy.id));
    return true;
  });
}

TEST(Arrangement, DoesNotDependOnTheDomain) {
  const Box small{{10.0, -30.0, 20.0}, {12.0, -28.0, 21.0}};
  for (const BlockType type : {BlockType::Tabular, BlockType::Columnar, BlockType::Rhombohedral}) {
    const Tile& tile = tile_of(type, 4);
    const Arrangement whole(tile, 0.5, kDomain), part(tile, 0.5, small);
    const auto copies = [&](const Arrangement& arrangement) {
      std::vector<Arrangement::Copy> found;
      arrangement.visit(small, [&](std::size_t index, const Arrangement::Copy& copy) {
        EXPECT_EQ(arrangement.index(copy.id), index);
        found.push_back(copy);
        return true;
      });
      return found;
    };
    const auto a = copies(whole), b = copies(part);
    ASSERT_FALSE(a.empty());
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].id, b[i].id);
      EXPECT_EQ(a[i].list, b[i].list);
      EXPECT_EQ(a[i].origin, b[i].origin);
    }
  }
}

TEST(Arrangement, UsesAllVariantsInSlabsAndRodsOfAllThicknesses) {
  const Tile& tile = tile_of(BlockType::Equidimensional, 4);
  const Arrangement arrangement(tile, 0.0, {Vec3(-200.0), Vec3(200.0)});
  std::set<std::size_t> lists;
  arrangement.visit({Vec3(-200.0), Vec3(200.0)}, [&](std::size_t, const Arrangement::Copy& copy) {
    lists.insert(copy.list);
    return true;
  });
  EXPECT_GT(lists.size(), arrangement.list_count() * 9 / 10);
}

TEST(Arrangement, StretchesBlocksWithoutTurningTheirJointsAway) {
  const Tile& tile = tile_of(BlockType::Rhombohedral, 4);
  const Arrangement arrangement(tile, 0.0, kDomain);
  const std::size_t per_variant = arrangement.list_count() / 4;
  const std::vector<Block> plain = arrangement.blocks(tile, per_variant / 2);  // in the middle: not stretched
  ASSERT_EQ(plain.size(), tile.blocks.size());
  for (std::size_t l = 0; l < per_variant; ++l) {
    const std::vector<Block> blocks = arrangement.blocks(tile, l);
    double volume = 0.0, plain_volume = 0.0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      volume += blocks[b].volume;
      plain_volume += plain[b].volume;
      for (std::size_t i = 0; i < blocks[b].planes.size(); ++i)
        ASSERT_GT(glm::dot(blocks[b].planes[i].normal, plain[b].planes[i].normal), std::cos(radians(15.0)));
    }
    EXPECT_GT(volume, 0.51 * plain_volume);
    EXPECT_LT(volume, 1.73 * plain_volume);
  }
}

TEST(Arrangement, RefusesADomainThatNobodyCanNumber) {
  EXPECT_THROW(Arrangement(tile_of(BlockType::Tabular, 1), 0.0, kDomain.moved(Vec3(1e9, 0, 0))), ParameterError);
}

}  // namespace
}  // namespace outcrop

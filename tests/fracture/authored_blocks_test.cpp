#include "outcrop/fracture/authored_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "outcrop/core/error.h"
#include "outcrop/fracture/tile.h"

namespace outcrop {
namespace {

Polytope turned_box(const Vec3& size, const Vec3& at, double angle) {
  std::vector<Vec3> corners;
  for (int c = 0; c < 8; ++c) {
    const Vec3 p = 0.5 * size * Vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
    const double c_angle = std::cos(angle), s_angle = std::sin(angle);
    corners.push_back(at + Vec3(c_angle * p.x - s_angle * p.y, s_angle * p.x + c_angle * p.y, p.z + 0.3 * p.x));
  }
  return hull_polytope(corners);
}

// A box across the tile's border, and a block like an L: two boxes that touch.
std::vector<AuthoredBlock> two_blocks() {
  return {{{turned_box({5, 4, 3}, {1, 10, 10}, 0.5)}},
          {{turned_box({6, 2, 2}, {11, 11, 4}, 0.0), moved(turned_box({2, 2, 4}, {0, 0, 0}, 0.0), {9, 11, 6.4})}}};
}

// Inside by more than rounding.
bool is_deep_in(const Polytope& shape, const Vec3& p) {
  return std::ranges::all_of(shape.faces, [&](const Polytope::Face& f) { return f.plane.distance(p) < -1e-7; });
}

// The numbers of the blocks (of their first parts) that hold a point.
std::vector<std::size_t> blocks_at(const Tile& tile, const Vec3& p, double margin) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < tile.blocks.size(); ++i) {
    const Block& block = tile.blocks[i];
    const Vec3 lo = glm::ceil((block.centre + block.bounds.lo - margin - p) / tile.side);
    const Vec3 hi = glm::floor((block.centre + block.bounds.hi + margin - p) / tile.side);
    for (double z = lo.z; z <= hi.z; ++z)
      for (double y = lo.y; y <= hi.y; ++y)
        for (double x = lo.x; x <= hi.x; ++x) {
          const Vec3 local = p + tile.side * Vec3(x, y, z) - block.centre;
          if (std::ranges::all_of(block.planes, [&](const Plane& plane) { return plane.distance(local) <= margin; }))
            found.push_back(i - block.part);
        }
  }
  std::ranges::sort(found);
  found.erase(std::ranges::unique(found).begin(), found.end());
  return found;
}

Vec3 random_point(double side, Rng& rng) {
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = side * rng.uniform();
  return p;
}

TEST(AuthoredBlocks, LeaveNoGapAndNoOverlapWhereCracksAreClosed) {
  for (const BlockType type : kBlockTypes) {
    // Chips are what a tenth of a spacing cannot hold: with few samples there are more of them.
    const Tile tile = make_tile({.type = type, .aperture = 0.0, .rounding = 0.0, .blocks = two_blocks()}, 2);
    SCOPED_TRACE(std::string(name(type)));
    EXPECT_LT(tile.statistics.filled_share, 1.0 + 1e-9);
    EXPECT_GT(tile.statistics.filled_share, 0.9985);
    Rng rng(1, "probes");
    int bare = 0;
    for (int i = 0; i < 3000; ++i) {
      const std::size_t covers = blocks_at(tile, random_point(tile.side, rng), -1e-9).size();
      ASSERT_LE(covers, 1u);
      bare += covers == 0;
    }
    EXPECT_LE(bare, 12);
  }
}

TEST(AuthoredBlocks, StandAsTheyWereGivenInOnePieceACrackAwayFromAllOthers) {
  const double aperture = 0.1;
  for (const Seed seed : {1, 2, 3}) {
    const std::vector<AuthoredBlock> authored = two_blocks();
    const Tile tile = make_tile({.aperture = aperture, .blocks = authored}, seed);
    const std::size_t last = tile.blocks.size();
    const std::size_t firsts[] = {last - 3, last - 2};
    Rng rng(seed, "probes");
    for (std::size_t b = 0; b < 2; ++b) {
      double volume = 0.0;
      for (std::size_t k = 0; k < tile.blocks[firsts[b]].parts; ++k) volume += tile.blocks[firsts[b] + k].volume;
      double expected = 0.0;
      for (const double own : without_covered(authored[b].parts, 1e-9).volumes) expected += own;
      EXPECT_NEAR(volume, expected, 1e-6);
      for (const Polytope& part : authored[b].parts)
        for (int i = 0; i < 400; ++i) {
          const Box box = part.bounds().grown(aperture);
          const Vec3 p = box.lo + rng.uniform() * Vec3(box.size().x, 0, 0) + rng.uniform() * Vec3(0, box.size().y, 0) +
                         rng.uniform() * Vec3(0, 0, box.size().z);
          const std::vector<std::size_t> found = blocks_at(tile, p, 0.0);
          const bool is_inside =
              std::ranges::any_of(authored[b].parts, [&](const Polytope& shape) { return is_deep_in(shape, p); });
          ASSERT_EQ(is_inside, std::ranges::count(found, firsts[b]) == 1);
          const bool is_near = std::ranges::all_of(
              part.faces, [&](const Polytope::Face& face) { return face.plane.distance(p) < aperture - 1e-7; });
          for (const std::size_t other : found) ASSERT_TRUE(!is_near || other == firsts[b]);
        }
    }
  }
}

TEST(AuthoredBlocks, AreFlushWithTheirNeighbours) {
  const double aperture = 0.04;
  const Polytope box = two_blocks()[0].parts[0];
  const Tile tile = make_tile({.aperture = aperture, .blocks = {{{box}}}}, 1);
  Rng rng(5, "probes");
  int flush = 0, probes = 0;
  for (const Polytope::Face& face : box.faces)
    for (int i = 0; i < 200; ++i) {
      Vec3 p(0.0);
      double sum = 0.0;
      for (const std::uint32_t v : face.loop) {
        const double weight = rng.uniform();
        p += weight * box.vertices[v];
        sum += weight;
      }
      ++probes;
      flush += blocks_at(tile, p / sum + (aperture + 1e-6) * face.plane.normal, 0.0).size() == 1;
    }
  EXPECT_GT(flush, 0.9 * probes);  // where joints end at the block there are cracks, and chips
}

TEST(AuthoredBlocks, HaveAnchorsOfTheWholeInEveryPart) {
  const Tile tile = make_tile({.blocks = two_blocks()}, 1);
  int parts = 0;
  for (std::size_t i = 0; i < tile.blocks.size(); ++i) {
    const Block& block = tile.blocks[i];
    const Block& first = tile.blocks[i - block.part];
    ASSERT_EQ(block.parts, first.parts);
    ASSERT_EQ(block.anchors.size(), first.anchors.size());
    parts += block.part > 0;
    for (std::size_t k = 0; k < block.anchors.size(); ++k)
      ASSERT_LT(glm::length(block.home + block.anchors[k] - first.home - first.anchors[k]), 1e-9);
    const Vec3 turns = (block.home - block.centre) / tile.side;
    ASSERT_LT(glm::length(turns - glm::round(turns)), 1e-9);
  }
  EXPECT_GT(parts, 5);
}

TEST(AuthoredBlocks, PartsThatTouchReachIntoEachOtherAndNowhereElse) {
  const Polytope lying = box_polytope({{0, 0, 0}, {4, 1, 1}}), standing = box_polytope({{0, 0, 1}, {1, 1, 3}});
  const std::vector<Polytope> welds = welded({lying, standing}, 0.5, 1e-9);
  EXPECT_NEAR(welds[0].volume(), 4.0, 1e-9);
  EXPECT_NEAR(welds[1].volume(), 2.5, 1e-9);
  const CutCell whole = without_covered(welds, 1e-9);
  EXPECT_NEAR(whole.volumes[0] + whole.volumes[1], 6.0, 1e-9);
}

TEST(AuthoredBlocks, DifferenceFillsWhatTheOtherDoesNot) {
  for (const Seed seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
    Rng rng(seed, "boxes");
    const Polytope a = turned_box({4, 3, 2}, random_point(1.0, rng), rng.uniform());
    const Polytope b = turned_box({2, 2, 3}, random_point(2.0, rng), rng.uniform());
    const std::vector<Polytope> pieces = difference(a, b, 1e-9);
    const std::vector<Polytope> others = difference(b, a, 1e-9);
    double of_a = a.volume(), of_b = b.volume();
    for (const Polytope& piece : pieces) of_a -= piece.volume();
    for (const Polytope& piece : others) of_b -= piece.volume();
    EXPECT_NEAR(of_a, of_b, 1e-9);  // what they share
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p = 5.0 * random_point(1.0, rng) - Vec3(2.0);
      const auto count = std::ranges::count_if(pieces, [&](const Polytope& piece) { return is_deep_in(piece, p); });
      ASSERT_LE(count, 1);
      ASSERT_TRUE(count == 0 || !is_deep_in(b, p));
    }
  }
}

TEST(AuthoredBlocks, ThatOverlapOrAreAsLongAsTheTileAreRefused) {
  const Polytope box = box_polytope({{1, 1, 1}, {5, 5, 5}});
  const auto fits = [](std::vector<AuthoredBlock> blocks) { return misfit(blocks, 20.0).empty(); };
  EXPECT_TRUE(fits({{{box}}, {{moved(box, {4, 0, 0})}}}));
  EXPECT_FALSE(fits({{{box}}, {{moved(box, {3, 0, 0})}}}));
  EXPECT_FALSE(fits({{{box}}, {{moved(box, {17, 20, -20})}}}));
  EXPECT_FALSE(fits({{{box_polytope({{0, 0, 0}, {19.5, 2, 2}})}}}));
  EXPECT_FALSE(fits({AuthoredBlock{}}));
  EXPECT_THROW((void)make_tile({.blocks = {AuthoredBlock{}}}, 1), ParameterError);
  EXPECT_THROW((void)make_tile({.variants = 2, .blocks = {{{box}}}}, 1), ParameterError);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/fracture/tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stop_token>

#include "outcrop/core/error.h"
#include "outcrop/core/parallel.h"

namespace outcrop {
namespace {

constexpr Seed kSeeds[] = {1, 2, 3};

// Tiles at the paper's setting, made once.
const Tile& paper_tile(BlockType type, Seed seed) {
  static std::map<std::pair<BlockType, Seed>, Tile> tiles;
  const auto [it, is_new] = tiles.try_emplace({type, seed});
  if (is_new) it->second = make_tile({.type = type}, seed);
  return it->second;
}

struct Found {
  const Block* block;
  Vec3 local;
};

std::vector<Found> blocks_at(const Tile& tile, const Vec3& p) {
  std::vector<Found> found;
  for (const Block& block : tile.blocks) {
    const Vec3 lo = glm::ceil((block.centre + block.bounds.lo - p) / tile.side);
    const Vec3 hi = glm::floor((block.centre + block.bounds.hi - p) / tile.side);
    for (double z = lo.z; z <= hi.z; ++z)
      for (double y = lo.y; y <= hi.y; ++y)
        for (double x = lo.x; x <= hi.x; ++x) {
          const Vec3 local = p + tile.side * Vec3(x, y, z) - block.centre;
          if (std::all_of(block.planes.begin(), block.planes.end(),
                          [&](const Plane& plane) { return plane.distance(local) <= 0.0; }))
            found.push_back({&block, local});
        }
  }
  return found;
}

template <class F>
double median(const Tile& tile, F&& value) {
  std::vector<double> values;
  for (const Block& block : tile.blocks) values.push_back(value(block));
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

double elongation(const Block& block) {
  const auto size = principal_sizes(block.hull);
  return size[0] / size[1];
}

double flatness(const Block& block) {
  const auto size = principal_sizes(block.hull);
  return size[1] / size[2];
}

// The share of face area, over all blocks, whose normal satisfies a predicate.
template <class F>
double area_share(const Tile& tile, F&& holds) {
  double all = 0.0;
  double some = 0.0;
  for (const Block& block : tile.blocks)
    for (const auto& t : block.hull.triangles) {
      const Vec3 n = glm::cross(block.hull.vertices[t[1]] - block.hull.vertices[t[0]],
                                block.hull.vertices[t[2]] - block.hull.vertices[t[0]]);
      const double area = 0.5 * glm::length(n);
      all += area;
      if (area > 0.0 && holds(glm::normalize(n))) some += area;
    }
  return some / all;
}

TEST(Tile, CoversTheTorusOnceButForItsCracks) {
  for (const BlockType type : kBlockTypes)
    for (const Seed seed : kSeeds) {
      SCOPED_TRACE(std::string(name(type)) + ", seed " + std::to_string(seed));
      const Tile& tile = paper_tile(type, seed);
      EXPECT_EQ(tile.statistics.overlap_share, 0.0);
      EXPECT_GT(tile.statistics.filled_share, 0.95);
      EXPECT_LT(tile.statistics.filled_share, 1.0);
      EXPECT_GT(tile.statistics.filled_share, tile.statistics.plain_filled_share + 0.1);
      Rng rng(seed, "probes");
      int covered = 0;
      const int probes = 2000;
      for (int i = 0; i < probes; ++i) {
        Vec3 p;
        for (int axis = 0; axis < 3; ++axis) p[axis] = tile.side * rng.uniform();
        const std::size_t covers = blocks_at(tile, p).size();
        ASSERT_LE(covers, 1u);
        covered += covers == 1;
      }
      EXPECT_NEAR(static_cast<double>(covered) / probes, tile.statistics.filled_share, 0.02);
    }
}

TEST(Tile, HasNoGapsWithoutAnAperture) {
  for (const BlockType type : kBlockTypes) {
    const Tile tile = make_tile({.type = type, .spacing = 1.2, .aperture = 0.0}, 4);
    EXPECT_NEAR(tile.statistics.filled_share, 1.0, 1e-9) << name(type);
    EXPECT_EQ(tile.statistics.overlap_share, 0.0) << name(type);
  }
}

TEST(Tile, NeighboursShareFlushFacesAcrossACrackOfTheAperture) {
  const double step = 1e-6;
  for (const BlockType type : kBlockTypes) {
    const Tile& tile = paper_tile(type, 1);
    const double aperture = TileOptions{}.aperture;
    int faces = 0;
    int flush = 0;
    for (const Block& block : tile.blocks)
      for (const auto& t : block.hull.triangles) {
        const Vec3 a = block.hull.vertices[t[0]];
        const Vec3 b = block.hull.vertices[t[1]];
        const Vec3 c = block.hull.vertices[t[2]];
        const Vec3 twice_area = glm::cross(b - a, c - a);
        if (glm::length(twice_area) < 1.0) continue;  // m²; small ones lie beside other cracks
        const Vec3 n = glm::normalize(twice_area);
        const Vec3 p = block.centre + (a + b + c) / 3.0;
        ++faces;
        EXPECT_TRUE(blocks_at(tile, p + 0.5 * aperture * n).empty()) << name(type);
        const auto beyond = blocks_at(tile, p + (aperture + step) * n);
        if (beyond.empty()) continue;  // the crack between two neighbours
        const bool is_flush =
            std::any_of(beyond[0].block->planes.begin(), beyond[0].block->planes.end(), [&](const Plane& plane) {
              return glm::dot(plane.normal, n) < -1.0 + 1e-9 && std::abs(plane.distance(beyond[0].local) + step) < 1e-8;
            });
        EXPECT_TRUE(is_flush) << name(type);
        flush += is_flush;
      }
    EXPECT_GT(faces, 500) << name(type);
    EXPECT_GT(flush, 0.93 * faces) << name(type);
  }
}

TEST(Tile, HasBlocksWhosePartsAgree) {
  for (const BlockType type : kBlockTypes)
    for (const Seed seed : kSeeds) {
      SCOPED_TRACE(std::string(name(type)) + ", seed " + std::to_string(seed));
      const Tile& tile = paper_tile(type, seed);
      std::size_t samples = 0;
      double volume = 0.0;
      for (const Block& block : tile.blocks) {
        samples += block.sample_count;
        volume += block.volume;
        for (int axis = 0; axis < 3; ++axis) ASSERT_TRUE(block.centre[axis] >= 0.0 && block.centre[axis] < tile.side);
        ASSERT_GT(block.inradius, 0.0);
        ASSERT_GE(block.rounding, 0.0);
        ASSERT_LE(block.rounding, std::min(TileOptions{}.rounding, 0.5 * block.inradius));
        ASSERT_GE(block.planes.size(), 4u);
        for (const Plane& plane : block.planes) {
          ASSERT_NEAR(glm::length(plane.normal), 1.0, 1e-9);
          ASSERT_LE(plane.offset, -block.inradius + 1e-9);
          int touching = 0;
          for (const Vec3& v : block.hull.vertices) {
            ASSERT_LT(plane.distance(v), 1e-7);
            touching += plane.distance(v) > -1e-6;
          }
          ASSERT_GE(touching, 3) << "each plane bounds a face";
        }
        ASSERT_GE(block.anchors.size(), 1u);
        ASSERT_LE(block.anchors.size(), 32u);
        for (const Vec3& a : block.anchors)
          for (const Plane& plane : block.planes) ASSERT_LE(plane.distance(a), 0.0);
        for (const Vec3& v : block.hull.vertices) ASSERT_TRUE(block.bounds.grown(1e-9).contains(v));
        const Vec3 size = block.bounds.size();
        ASSERT_LT(std::max(size.x, std::max(size.y, size.z)), tile.side);
      }
      EXPECT_EQ(samples, tile.statistics.samples);
      EXPECT_NEAR(volume, tile.statistics.filled_share * std::pow(tile.side, 3), 1e-6);
    }
}

TEST(Tile, ComesNearToTableOneOfThePaper) {
  const std::map<BlockType, double> paper{{BlockType::Equidimensional, 125},
                                          {BlockType::Rhombohedral, 78},
                                          {BlockType::Polyhedral, 100},
                                          {BlockType::Tabular, 82}};
  for (const auto& [type, expected] : paper) {
    double blocks = 0.0;
    for (const Seed seed : kSeeds) {
      blocks += static_cast<double>(paper_tile(type, seed).blocks.size()) / std::size(kSeeds);
      EXPECT_NEAR(static_cast<double>(paper_tile(type, seed).statistics.samples), 14'500.0, 1'450.0);
    }
    EXPECT_LT(blocks, 1.5 * expected) << name(type);
    EXPECT_GT(blocks, expected / 1.5) << name(type);
  }
}

TEST(Tile, KnowsTheJointOfEveryPlane) {
  for (const BlockType type : kBlockTypes)
    for (const Seed seed : kSeeds) {
      SCOPED_TRACE(std::string(name(type)) + ", seed " + std::to_string(seed));
      const Tile& tile = paper_tile(type, seed);
      ASSERT_GE(tile.discs.size(), tile.statistics.discs);
      for (const Block& block : tile.blocks) {
        ASSERT_EQ(block.plane_joint.size(), block.planes.size());
        for (std::size_t i = 0; i < block.planes.size(); ++i) {
          const int joint = block.plane_joint[i];
          if (joint < 0) {
            ASSERT_TRUE(joint == kAddedJoint || joint == kColumnJoint);
            continue;
          }
          ASSERT_LT(joint, static_cast<int>(tile.discs.size()));
          const Disc& disc = tile.discs[static_cast<std::size_t>(joint)];
          ASSERT_GT(std::abs(glm::dot(disc.normal, block.planes[i].normal)), 1.0 - 1e-11);
          ASSERT_LT(disc.set, static_cast<int>(tile.sets.size()));
        }
      }
    }
}

TEST(Tile, HasTheShapesOfItsType) {
  for (const Seed seed : kSeeds) {
    SCOPED_TRACE(seed);
    const auto along_axes = [](const Vec3& n) {
      return glm::max(std::abs(n.x), glm::max(std::abs(n.y), std::abs(n.z))) > 0.92;
    };
    const auto level = [](const Vec3& n) { return std::abs(n.z) > 0.97; };

    const Tile& equal = paper_tile(BlockType::Equidimensional, seed);
    EXPECT_LT(median(equal, elongation), 2.0);
    EXPECT_LT(median(equal, flatness), 2.0);
    EXPECT_GT(area_share(equal, along_axes), 0.75);

    const Tile& oblique = paper_tile(BlockType::Rhombohedral, seed);
    EXPECT_LT(area_share(oblique, along_axes), 0.1);
    EXPECT_LT(median(oblique, elongation), 2.0);

    const Tile& stochastic = paper_tile(BlockType::Polyhedral, seed);
    EXPECT_LT(area_share(stochastic, along_axes), 0.5);
    EXPECT_GT(area_share(stochastic, along_axes), 0.05);

    const Tile& flat = paper_tile(BlockType::Tabular, seed);
    EXPECT_GT(median(flat, flatness), 2.0);
    EXPECT_GT(area_share(flat, level), 0.5);

    const Tile& columns = paper_tile(BlockType::Columnar, seed);
    EXPECT_GT(median(columns, elongation), 2.0);
    EXPECT_LT(median(columns, flatness), 1.5);
    EXPECT_NEAR(columns.statistics.mean_planes, 8.0, 0.5) << "six sides on average, and two ends";

    const Tile& prisms = paper_tile(BlockType::Prismatic, seed);
    EXPECT_GT(median(prisms, elongation), 2.0);
    EXPECT_LT(median(prisms, flatness), 2.0);
  }
}

TEST(Tile, HasColumnsWithTheIntensityOfVoronoiPrisms) {
  // Lateral P32 is the length of Voronoi edges an area: 1.861 d⁻¹ √(√3/2)… between hexagons, 2/d, and Poisson seeds,
  // 2√q.
  const Tile& tile = paper_tile(BlockType::Columnar, 1);
  const double width = joint_pattern(BlockType::Columnar).columns[0].width;
  double area = 0.0;
  for (const Block& block : tile.blocks)
    for (const auto& t : block.hull.triangles) {
      const Vec3 n = glm::cross(block.hull.vertices[t[1]] - block.hull.vertices[t[0]],
                                block.hull.vertices[t[2]] - block.hull.vertices[t[0]]);
      if (std::abs(n.z) < 1e-6 * glm::length(n)) area += 0.25 * glm::length(n);  // each face belongs to two blocks
    }
  const double p32 = area / std::pow(tile.side, 3);
  EXPECT_GT(p32, 0.95 * 2.0 / width) << "no tiling by columns has less than hexagons";
  EXPECT_LT(p32, 2.0 * std::sqrt(1.0 / (0.866 * width * width)));
}

TEST(Tile, HasTheJointAreaThatSetsAskForHoweverDiscsGrow) {
  const auto set = [](const char* name, const Vec3& normal, JointSet like) {
    like.name = name;
    like.normal = normal;
    return like;
  };
  const JointSet planes{.kappa = 200, .spacing = 3.0, .radius_law = RadiusLaw::Persistent};
  const JointSet small{.kappa = 200, .p32 = 0.3, .radius_lo = 3.0, .radius_hi = 5.0};
  const JointSet sheets{.kappa = 200, .spacing = 2.0, .persistence = 0.6, .radius_lo = 3.0, .radius_hi = 5.0};
  for (const JointSet& like : {planes, small, sheets}) {
    double ratio = 0.0, growth = 0.0;
    for (Seed seed = 1; seed <= 6; ++seed) {
      const Tile tile = make_tile(
          {.pattern = {.sets = {set("a", {1, 0, 0}, like), set("b", {0, 1, 0}, like), set("c", {0, 0, 1}, like)}},
           .spacing = 0.85},
          seed);
      ASSERT_EQ(tile.statistics.intensities.size(), 3u);
      for (const SetIntensity& got : tile.statistics.intensities) {
        ratio += got.made / got.asked / 18.0;
        growth += got.made / std::max(got.drawn, 1e-9) / 18.0;
      }
    }
    EXPECT_NEAR(ratio, 1.0, 0.1);
    EXPECT_GT(growth, 1.2) << "else nothing would need to be made up for";
  }
}

TEST(Tile, IsTheSameOnOneThreadAndOnMany) {
  const auto bytes_of = [](int threads) {
    const ThreadLimit limit(threads);
    const Tile tile = make_tile({.type = BlockType::Polyhedral, .spacing = 1.2}, 9);
    std::vector<double> numbers;
    for (const Block& block : tile.blocks) {
      for (const Plane& plane : block.planes) numbers.push_back(plane.offset);
      for (const Vec3& v : block.hull.vertices) numbers.push_back(v.x);
      for (const Vec3& a : block.anchors) numbers.push_back(a.z);
      numbers.push_back(block.volume);
    }
    return numbers;
  };
  EXPECT_EQ(bytes_of(1), bytes_of(4));
}

TEST(Tile, ScalesWithItsSide) {
  const Tile small = make_tile({.type = BlockType::Tabular, .side = 2.0, .spacing = 0.12, .aperture = 0.0}, 2);
  const Tile large = make_tile({.type = BlockType::Tabular, .side = 64.0, .spacing = 3.84, .aperture = 0.0}, 2);
  ASSERT_EQ(small.blocks.size(), large.blocks.size());
  for (std::size_t i = 0; i < small.blocks.size(); ++i)
    EXPECT_NEAR(small.blocks[i].volume * 32768.0, large.blocks[i].volume, 1e-6 * large.blocks[i].volume);
}

TEST(Tile, KeepsChipsWhenAsked) {
  JointPattern pattern = joint_pattern(BlockType::Polyhedral);
  pattern.least_thickness = 0.0;
  pattern.least_angle = 0.0;
  const Tile chips =
      make_tile({.type = BlockType::Polyhedral, .pattern = pattern, .spacing = 1.2, .min_block_samples = 1}, 2);
  const Tile merged =
      make_tile({.type = BlockType::Polyhedral, .pattern = pattern, .spacing = 1.2, .min_block_samples = 12}, 2);
  EXPECT_GT(chips.blocks.size(), merged.blocks.size());
  EXPECT_TRUE(std::any_of(chips.blocks.begin(), chips.blocks.end(), [](const Block& b) { return b.sample_count < 4; }));
  EXPECT_EQ(chips.statistics.overlap_share, 0.0);
}

TEST(Tile, RefusesOptionsOutsideTheirBounds) {
  const auto refuses = [](const TileOptions& options) { EXPECT_THROW((void)make_tile(options, 1), ParameterError); };
  refuses({.side = 0.0});
  refuses({.side = NAN});
  refuses({.spacing = 5.0});
  refuses({.spacing = -1.0});
  refuses({.neighbour_factor = 0.5});
  refuses({.spacing = 2.5, .neighbour_factor = 4.0});
  refuses({.aperture = -0.1});
  refuses({.aperture = 1.0});
  refuses({.rounding = -1.0});
  refuses({.min_block_samples = 0});
}

TEST(Tile, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW((void)make_tile({}, 1, {.stop = source.get_token()}), Cancelled);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/fracture/trace_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fracture/hand_tiles.h"
#include "outcrop/core/error.h"
#include "outcrop/fracture/rock_statistics.h"

namespace outcrop {
namespace {

TEST(TraceMap, ShowsAPersistentJointAsOneLine) {
  const double side = 10.0;
  const Tile tile =
      test::grid_tile(side, {test::even_places(side, 5), test::even_places(side, 2), test::even_places(side, 3)}, 0.1);
  const CutPlane cut{.origin = Vec3(0.1, 0.2, 3.3), .width = 10.0, .height = 20.0};
  const std::vector<Trace> traces = trace_map(tile, cut);
  int across_x = 0;
  int across_y = 0;
  for (const Trace& trace : traces) {
    across_x += trace.set == 0;
    across_y += trace.set == 1;
    EXPECT_NEAR(trace.length(), trace.set == 0 ? 20.0 : 10.0, 1e-9);
  }
  EXPECT_EQ(across_x, 5);
  EXPECT_EQ(across_y, 4);  // 20 m high: each joint twice
  EXPECT_EQ(traces.size(), 9u);
  EXPECT_NEAR(intensity_p21(traces, cut), 1.0 / 2.0 + 1.0 / 5.0, 1e-9);
}

// P21 on planes of all directions averages to π/4 P32.
TEST(TraceMap, CutsInAllDirectionsAgreeWithTheAreas) {
  const Tile tile = make_tile({.type = BlockType::Polyhedral}, 5);
  const double p32 = measure_rock(tile).p32;
  double p21 = 0.0;
  const int cuts = 120;
  for (int i = 0; i < cuts; ++i) {
    Rng rng(1, "cuts", static_cast<std::uint64_t>(i));
    const Vec3 n = rng.direction();
    const Vec3 u = glm::normalize(glm::cross(n, std::abs(n.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
    const CutPlane cut{.origin = Vec3(7.0 * i, 3.0, 5.0 * i), .u = u, .v = glm::cross(n, u), .width = 30, .height = 30};
    p21 += intensity_p21(trace_map(tile, cut), cut) / cuts;
  }
  EXPECT_NEAR(p21 / (kPi / 4.0 * p32), 1.0, 0.03);
}

TEST(TraceMap, HoldsWhateverTheCutsOrigin) {
  // Moved by whole tiles, the map is the same.
  const Tile tile = make_tile({.type = BlockType::Prismatic}, 2);
  const CutPlane a{.origin = Vec3(1, 2, 3)};
  const CutPlane b{.origin = Vec3(1, 2, 3) + 20.0 * Vec3(-2, 5, 1)};
  const auto first = trace_map(tile, a);
  const auto second = trace_map(tile, b);
  ASSERT_EQ(first.size(), second.size());
  EXPECT_NEAR(intensity_p21(first, a), intensity_p21(second, b), 1e-9);
  for (const Trace& trace : first) {
    EXPECT_GE(std::min({trace.a.x, trace.a.y, trace.b.x, trace.b.y}), -1e-9);
    EXPECT_LE(std::max({trace.a.x, trace.a.y, trace.b.x, trace.b.y}), 20.0 + 1e-9);
  }
}

TEST(TraceMap, RefusesAPlaneThatIsNone) {
  const Tile tile = test::grid_tile(1.0, {test::even_places(1.0, 2), test::even_places(1.0, 2), {0.5}}, 0.0);
  EXPECT_THROW((void)trace_map(tile, {.u = Vec3(2, 0, 0)}), ParameterError);
  EXPECT_THROW((void)trace_map(tile, {.v = glm::normalize(Vec3(1, 1, 0))}), ParameterError);
  EXPECT_THROW((void)trace_map(tile, {.width = 0.0}), ParameterError);
  EXPECT_EQ(trace_table(tile, {}), "x0,y0,x1,y1,set\n");
}

}  // namespace
}  // namespace outcrop

#include "outcrop/mesh/mesh_measure.h"

#include <gtest/gtest.h>

#include <array>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/mesh/check_mesh.h"

namespace outcrop {
namespace {

TEST(MeshMeasure, AgreesWithTheCheckOfTheWholeMesh) {
  const FieldPtr ball = sphere({0.3, 0.1, -0.2}, 2.0);
  for (const Border border : {Border::Open, Border::Closed}) {
    // The region cuts the ball: an open sheet has a border.
    const PolygonizeOptions options{.region = {Vec3(-3.0), Vec3(3.0, 3.0, 1.0)}, .resolution = 0.2, .border = border};
    MeshMeasure measure;
    MeshSink* const sinks[] = {&measure};
    polygonize_pieces(*ball, options, {.squares = 1}, sinks);
    const MeshCheck check = check_mesh(polygonize(*ball, options).mesh);
    EXPECT_EQ(measure.vertices(), check.vertices);
    EXPECT_EQ(measure.triangles(), check.triangles);
    EXPECT_EQ(measure.closed(), check.closed());
    EXPECT_NEAR(measure.area(), check.area, 1e-6 * check.area);
    if (check.closed()) {
      EXPECT_NEAR(measure.volume(), check.volume, 1e-6 * check.volume);
    }
  }
}

TEST(MeshMeasure, FindsAMissingAndATurnedTriangle) {
  const PolygonizeOptions options{.region = {Vec3(-1.5), Vec3(1.5)}, .resolution = 0.25};
  const TriangleMesh whole = polygonize(*sphere(Vec3(0.0), 1.0), options).mesh;
  MeshMeasure measure;
  feed(whole, measure);
  EXPECT_TRUE(measure.closed());
  Rng rng(1, "mesh measure test");
  for (int i = 0; i < 50; ++i) {
    const auto which = static_cast<std::size_t>(rng.uniform() * static_cast<double>(whole.triangles.size()));
    TriangleMesh broken = whole;
    if (i % 2)
      broken.triangles.erase(broken.triangles.begin() + static_cast<std::ptrdiff_t>(which));
    else
      std::swap(broken.triangles[which][0], broken.triangles[which][1]);
    feed(broken, measure);
    EXPECT_FALSE(measure.closed());
  }
}

}  // namespace
}  // namespace outcrop

/// The mesher together with real fields: what `narrow` and `bound` leave out must not show.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "fields.h"
#include "outcrop/core/parallel.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/implicit/primitives.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop {
namespace {

/// The same field without narrowing, and with the default bound.
class Whole final : public Field {
 public:
  explicit Whole(FieldPtr field) : field_(std::move(field)) {}
  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    field_->values(points, values, gradients);
  }
  void labels(const Points& points, std::span<Label> labels) const noexcept override { field_->labels(points, labels); }
  [[nodiscard]] double lipschitz() const noexcept override { return field_->lipschitz(); }

 private:
  FieldPtr field_;
};

/// Ground with boulders, a cave and a label for each boulder.
FieldPtr boulders(Seed seed) {
  std::vector<FieldPtr> rocks{labelled(slab(-20.0, 0.0), 7)};
  for (std::uint64_t i = 0; i < 60; ++i) {
    Rng rng(seed, "boulder", i);
    const double x = rng.uniform(-4.0, 4.0), y = rng.uniform(-4.0, 4.0), z = rng.uniform(-0.5, 2.5),
                 r = rng.uniform(0.2, 0.7);
    const Vec3 c(x, y, z);
    rocks.push_back(
        labelled(i % 2 == 0 ? sphere(c, r) : box_solid({c - Vec3(r), c + Vec3(r)}, 0.3 * r), static_cast<Label>(i)));
  }
  return difference_of(union_of(std::move(rocks)), sphere({0, 0, -1}, 1.5));
}

TEST(NarrowedMesh, IsTheMeshOfTheWholeField) {
  for (Seed seed = 0; seed < 3; ++seed) {
    const FieldPtr field = boulders(seed);
    const PolygonizeOptions options{.region = {{-4, -4, -3}, {4, 4, 3}}, .resolution = 0.17, .border = Border::Closed};
    const TriangleMesh narrowed = polygonize(*field, options).mesh;
    const TriangleMesh whole = polygonize(*std::make_shared<Whole>(field), options).mesh;
    EXPECT_EQ(narrowed.positions, whole.positions) << "seed " << seed;
    EXPECT_EQ(narrowed.triangles, whole.triangles) << "seed " << seed;
    EXPECT_EQ(narrowed.labels, whole.labels) << "seed " << seed;
    EXPECT_EQ(narrowed.normals, whole.normals) << "seed " << seed;
    const MeshCheck check = check_mesh(narrowed);
    EXPECT_TRUE(check.closed()) << "seed " << seed;
    EXPECT_EQ(check.nonmanifold_vertices, 0u) << "seed " << seed;
    EXPECT_GT(check.volume, 0.0) << "seed " << seed;
  }
}

TEST(NarrowedMesh, LeavesNoBoulderInTheAir) {
  for (Seed seed = 0; seed < 3; ++seed) {
    for (const Border border : {Border::Open, Border::Closed}) {
      const PolygonizeResult result = polygonize(
          *boulders(seed),
          {.region = {{-4, -4, -3}, {4, 4, 3}}, .resolution = 0.17, .border = border, .parts = Parts::Grounded});
      EXPECT_GT(result.statistics.parts_removed, 0u) << "seed " << seed;
      EXPECT_TRUE(border == Border::Open || check_mesh(result.mesh).parts == 1) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace outcrop

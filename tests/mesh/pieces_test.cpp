/// A mesh in pieces is the mesh in one.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

#include "core/scratch.h"
#include "fields.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/core/parallel.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/mesh/write_mesh.h"

namespace outcrop {
namespace {

using test::Scratch;

/// Ground with caves, overhangs and floating stones, and a material in each half.
FieldPtr scene() {
  const FieldPtr rough = test::waves(4, 1.3, 0.0);
  const FieldPtr ground = test::formula(
      [=](const Vec3& p) { return std::max(std::min(p.z, 0.6 * rough->value(p)), -2.0 - p.z) + 0.2 * p.z; }, 4.0);
  return ground;
}

PolygonizeOptions options(double tolerance, Border border) {
  return {.region = {{-3, -3, -1}, {3.3, 3.1, 1.5}},
          .resolution = 0.05,
          .tolerance = tolerance,
          .crisp = border == Border::Closed,  // With and without vertices on creases.
          .border = border,
          .parts = Parts::Grounded};
}

TEST(MeshPieces, JoinToTheSameBytesHoweverManyTheyAre) {
  const Scratch folder;
  const FieldPtr field = scene();
  const MeshMetadata metadata{.comments = {"test"}, .material_names = {"rock"}};
  for (const double tolerance : {0.0, 0.01})
    for (const Border border : {Border::Open, Border::Closed}) {
      const PolygonizeResult whole = polygonize(*field, options(tolerance, border));
      ASSERT_GT(whole.statistics.parts_removed + whole.statistics.voids_removed, 0u);
      ASSERT_GT(whole.mesh.triangles.size(), 50'000u);
      for (const std::string extension : {".ply", ".obj", ".stl"}) {
        write_mesh(folder / ("whole" + extension), whole.mesh, metadata);
      }
      for (const std::size_t squares : {1, 7}) {
        const ThreadLimit threads(squares == 7 ? 2 : 1);
        std::array<std::unique_ptr<MeshSink>, 3> writers = {mesh_writer(folder / "pieces.ply", metadata),
                                                            mesh_writer(folder / "pieces.obj", metadata),
                                                            mesh_writer(folder / "pieces.stl", metadata)};
        MeshSink* const sinks[] = {writers[0].get(), writers[1].get(), writers[2].get()};
        const PolygonizeStatistics statistics = polygonize_pieces(
            *field, options(tolerance, border), {.squares = squares, .spool = folder / "pieces.ply"}, sinks);
        EXPECT_EQ(statistics.parts_removed, whole.statistics.parts_removed);
        EXPECT_EQ(statistics.voids_removed, whole.statistics.voids_removed);
        for (const std::string extension : {".ply", ".obj", ".stl"})
          EXPECT_TRUE(read_text(folder / ("pieces" + extension)) == read_text(folder / ("whole" + extension)))
              << extension << " in pieces of " << squares << " squares, tolerance " << tolerance;
      }
    }
  EXPECT_EQ(folder.entries(), 6u);
}

TEST(MeshPieces, MoveTheirOriginAsRebasedMeshesDo) {
  const Scratch folder;
  const Vec3 origin(-1000, 2000, 0);
  const PolygonizeOptions wanted = options(0.01, Border::Open);
  write_mesh(folder / "whole.ply", rebased(polygonize(*scene(), wanted).mesh, origin));
  const auto writer = mesh_writer(folder / "pieces.ply", {.origin = origin});
  MeshSink* const sinks[] = {writer.get()};
  (void)polygonize_pieces(*scene(), wanted, {}, sinks);
  EXPECT_TRUE(read_text(folder / "pieces.ply") == read_text(folder / "whole.ply"));
}

/// Asks for a stop when the first piece comes.
class Stopper final : public MeshSink {
 public:
  explicit Stopper(std::stop_source& stop) : stop_(stop) {}
  void begin(const MeshTotals&) override {}
  void add(const MeshPiece&) override { stop_.request_stop(); }

 private:
  std::stop_source& stop_;
};

TEST(MeshPieces, LeaveNoFileBehindWhenStopped) {
  const Scratch folder;
  std::stop_source stop;
  Stopper stopper(stop);
  const Task task{.stop = stop.get_token()};
  {
    const auto writer = mesh_writer(folder / "mesh.ply", {}, task);
    MeshSink* const sinks[] = {writer.get(), &stopper};
    EXPECT_THROW((void)polygonize_pieces(*scene(), options(0.0, Border::Open),
                                         {.squares = 2, .spool = folder / "mesh.ply"}, sinks, task),
                 Cancelled);
  }
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace outcrop

#include "outcrop/amplify/run_amplify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/scratch.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/core/image.h"
#include "outcrop/core/json.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/write_mesh.h"
#include "terraces.h"

namespace outcrop {
namespace {

/// A folder with terraces.exr and a strata file of small blocks.
class RunAmplifyTest : public testing::Test {
 protected:
  RunAmplifyTest() {
    const ElevationGrid grid = test::terraces().grid();
    Image image{.width = grid.width, .height = grid.height, .channels = 1, .pixels = grid.elevations, .channel_names = {"Y"}};
    write_image(folder_ / "terraces.exr", image);
    std::ofstream(folder_ / "strata.json") << R"({"materials": [{"name": "gneiss", "tile_side": 8, "sample_spacing": 0.45}]})";
    std::filesystem::create_directory(folder_ / "out");
  }

  AmplifyRun run(std::vector<std::string> meshes) {
    AmplifyRun run;
    run.heightmap = folder_ / "terraces.exr";
    run.strata = folder_ / "strata.json";
    for (const std::string& mesh : meshes) run.meshes.push_back(folder_ / ("out/" + mesh));
    run.region = {10, 20, 40, 40};
    run.resolution = 0.3;
    run.width = 64;
    run.height = 36;
    return run;
  }
  std::size_t outputs() {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_ / "out"), {}));
  }

  test::Scratch folder_;
};

TEST_F(RunAmplifyTest, WritesEveryKindOfOutput) {
  AmplifyRun job = run({"a.ply", "a.obj", "a.stl", "a.vdb"});
  job.previews = {folder_ / "out/a.png", folder_ / "out/a.exr"};
  job.report = folder_ / "out/a.json";
  job.command = "amplify terraces.exr";
  std::vector<std::string> lines;
  EXPECT_EQ(run_amplify(job, [&](const std::string& line) { lines.push_back(line); }), "");
  EXPECT_EQ(outputs(), 7u);
  const std::size_t triangles = read_mesh(job.meshes[0]).triangles.size();
  EXPECT_GT(triangles, 10'000u);
  EXPECT_EQ(read_mesh(job.meshes[1]).triangles.size(), triangles);
  EXPECT_EQ(read_mesh(job.meshes[2]).triangles.size(), triangles);
  EXPECT_EQ(read_image(job.previews[0]).width, 64);
  EXPECT_GE(read_image(job.previews[1]).channels, 8);

  const Json report = read_json(job.report);
  JsonReader reader(report);
  EXPECT_EQ(reader.string("command", ""), "amplify terraces.exr");
  EXPECT_GT(reader.number("replicated_blocks", 0), 10);
  EXPECT_GT(reader.number("rock_coverage", 0), 0.5);
  EXPECT_GT(reader.number("peak_memory", 0), 1e6);
  EXPECT_EQ(reader.array("outputs").size(), 7u);
  JsonReader mesh(*reader.child("mesh"));
  EXPECT_EQ(mesh.number("triangles", 0), double(triangles));
  const std::vector<Json>& rocks = reader.array("rocks");
  ASSERT_EQ(rocks.size(), 1u);
  JsonReader rock(rocks[0]);
  EXPECT_EQ(rock.string("material", ""), "gneiss");
  EXPECT_EQ(rock.number("tile_blocks", 0), double(rock.array("blocks").size()));
}

TEST_F(RunAmplifyTest, GivesTheSameBytesOnOneThreadAndTwo) {
  AmplifyRun one = run({"one.ply"}), two = run({"two.ply"});
  one.previews = {folder_ / "out/one.exr"};
  two.previews = {folder_ / "out/two.exr"};
  one.threads = 1;
  two.threads = 2;
  (void)run_amplify(one);
  (void)run_amplify(two);
  EXPECT_EQ(read_text(one.meshes[0]), read_text(two.meshes[0]));
  EXPECT_EQ(read_text(one.previews[0]), read_text(two.previews[0]));
}

TEST_F(RunAmplifyTest, SolidMeshesAreClosedInOnePieceAndSheetsAreOpen) {
  AmplifyRun job = run({"solid.ply"});
  job.solid = true;
  (void)run_amplify(job);
  const MeshCheck solid = check_mesh(read_mesh(job.meshes[0]));
  EXPECT_TRUE(solid.closed());
  EXPECT_EQ(solid.parts, 1u);
  EXPECT_GT(solid.volume, 0.0);
  AmplifyRun open = run({"sheet.ply"});
  (void)run_amplify(open);
  EXPECT_GT(check_mesh(read_mesh(open.meshes[0])).open_edges, 0u);
}

TEST_F(RunAmplifyTest, MeshesCountFromTheSouthWestCornerAndKeepElevations) {
  AmplifyRun job = run({"a.ply"});
  (void)run_amplify(job);
  const TriangleMesh mesh = read_mesh(job.meshes[0]);
  const Heightfield terrain = test::terraces();
  const double flat = std::tan(radians(20.0));
  std::size_t level = 0;
  for (const Vec3f& p : mesh.positions) {
    ASSERT_GE(p.x, 10.0f - 1e-3f);
    ASSERT_LE(p.y, 40.0f + 0.31f);
    // Away from steep ground the surface is the input's.
    bool away = true;
    for (double dy = -8.0; dy <= 8.0; dy += 2.0)
      for (double dx = -8.0; dx <= 8.0; dx += 2.0) {
        const Heightfield::Sample s = terrain.at(p.x + dx, p.y + dy);
        away = away && std::hypot(s.hx, s.hy) < flat;
      }
    if (!away) continue;
    ++level;
    ASSERT_NEAR(p.z, terrain.at(p.x, p.y).h, 0.02 * 0.3) << "the mesher keeps off the ends of edges by 2 % of a cell";
  }
  EXPECT_GT(level, 20u);
}

TEST_F(RunAmplifyTest, ADryRunTellsAndWritesNothing) {
  AmplifyRun job = run({"a.ply"});
  job.dry_run = true;
  const std::string text = run_amplify(job);
  for (const char* word : {"blocks", "cells", "triangles", "seconds", "memory", "a.ply"})
    EXPECT_NE(text.find(word), std::string::npos) << text;
  EXPECT_EQ(outputs(), 0u);
}

/// How often a stage begins.
class CountStage final : public Progress {
 public:
  explicit CountStage(std::string stage) : stage_(std::move(stage)) {}
  void begin(std::string_view stage, std::size_t) override { count += stage == stage_; }
  void advance(std::size_t) override {}

  int count = 0;

 private:
  std::string stage_;
};

TEST_F(RunAmplifyTest, ALevelSetSharesTheMeshOfASheetAndChangesNoByteOfIt) {
  CountStage meshings("meshing");
  (void)run_amplify(run({"both.ply", "both.vdb"}), {}, {.stop = {}, .progress = &meshings});
  EXPECT_EQ(meshings.count, 1);
  (void)run_amplify(run({"alone.ply"}));
  (void)run_amplify(run({"alone.vdb"}));
  EXPECT_EQ(read_text(folder_ / "out/both.ply"), read_text(folder_ / "out/alone.ply"));
  EXPECT_EQ(read_text(folder_ / "out/both.vdb"), read_text(folder_ / "out/alone.vdb"));
}

TEST_F(RunAmplifyTest, ADryRunCountsTheLevelSet) {
  const auto memory = [&](std::vector<std::string> meshes) {
    AmplifyRun job = run(std::move(meshes));
    job.dry_run = true;
    job.resolution = 0.1;
    const std::string text = run_amplify(job);
    const std::string bytes = text.substr(text.find("memory") + 6);
    std::size_t end = 0;
    const double number = std::stod(bytes, &end);
    return number * (bytes.compare(end, 3, " GB") == 0 ? 1e9 : bytes.compare(end, 3, " MB") == 0 ? 1e6 : 0.0);
  };
  const double both = memory({"a.ply", "a.vdb"});  // First: what the process has held so far counts too.
  const double alone = memory({"a.ply"});
  EXPECT_GT(alone, 1e6);
  EXPECT_GT(both, alone + 50e6);
}

TEST_F(RunAmplifyTest, StoppingLeavesNothingBehind) {
  /// Stops the run at the first step of a stage.
  class StopAt final : public Progress {
   public:
    StopAt(std::string stage, std::stop_source& source) : stage_(std::move(stage)), source_(source) {}
    void begin(std::string_view stage, std::size_t) override {
      if (stage.starts_with(stage_)) source_.request_stop();
    }
    void advance(std::size_t) override {}

   private:
    std::string stage_;
    std::stop_source& source_;
  };
  for (const char* stage : {"reading", "meshing", "writing"}) {
    std::stop_source source;
    StopAt stop(stage, source);
    EXPECT_THROW((void)run_amplify(run({"a.ply"}), {}, {source.get_token(), &stop}), Cancelled) << stage;
    EXPECT_EQ(outputs(), 0u) << stage;
  }
}

TEST_F(RunAmplifyTest, RefusesBeforeItWorks) {
  const auto error_of = [&](const AmplifyRun& job) { return test::message_of<ParameterError>([&] { (void)run_amplify(job); }); };
  AmplifyRun job = run({"a.glb"});
  EXPECT_NE(error_of(job).find(".ply, .obj, .stl or .vdb"), std::string::npos);
  job = run({"gone/a.ply"});
  EXPECT_NE(error_of(job).find("gone"), std::string::npos);
  job = run({"a.ply", "../out/a.ply"});
  EXPECT_NE(error_of(job).find("twice"), std::string::npos);
  job = run({"a.ply"});
  job.report = job.heightmap;
  EXPECT_NE(error_of(job).find("input"), std::string::npos);
  job = run({"a.vdb"});  // Measured from a mesh that is all there; others are written while they are made.
  job.resolution = 0.02;
  job.memory_limit_gib = 0.01;
  EXPECT_NE(error_of(job).find("resolution"), std::string::npos) << error_of(job);
  EXPECT_EQ(outputs(), 0u);
}

}  // namespace
}  // namespace outcrop

/// The polygonizer against OpenVDB on one model, one thread; and what another program needs to race it: the model as an
/// expression, a judge of its mesh. bench/race.py makes the table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "outcrop/core/parallel.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/mesh/write_mesh.h"
#include "race_clock.h"
#include "race_model.h"
#include "race_openvdb.h"

namespace {

using outcrop::Box;
using outcrop::TriangleMesh;
using outcrop::Vec3;
namespace race = outcrop::race;

const Box kRegion{Vec3(-race::kHalf), Vec3(race::kHalf)};

/// One of several runs: what it took, by stage, and its mesh.
struct Run {
  std::vector<double> seconds;  ///< The whole first.
  TriangleMesh mesh;
};

/// The run of median time.
Run median(int repetitions, const std::function<Run()>& run) {
  std::vector<Run> runs;
  for (int i = 0; i < repetitions; ++i) {
    runs.push_back(run());
    if (i > 0) runs.back().mesh = {};  // All alike.
  }
  TriangleMesh mesh = std::move(runs.front().mesh);
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.seconds[0] < b.seconds[0]; });
  return {runs[runs.size() / 2].seconds, std::move(mesh)};
}

Run by_outcrop(const outcrop::Field& field, double resolution, bool normals) {
  const outcrop::PolygonizeOptions options{
      .region = kRegion, .resolution = resolution, .keep_voids = true, .normals = normals, .labels = false};
  const race::CpuClock clock;
  outcrop::PolygonizeResult result = outcrop::polygonize(field, options);
  return {{clock.seconds()}, std::move(result.mesh)};
}

Run by_openvdb(const outcrop::Field& field, double resolution, int band) {
  race::OpenVdbRun run = race::mesh_by_openvdb(field, kRegion, resolution, band);
  return {{run.fill_seconds + run.mesh_seconds, run.fill_seconds, run.mesh_seconds}, std::move(run.mesh)};
}

std::string checked(const TriangleMesh& mesh) {
  const outcrop::MeshCheck check = outcrop::check_mesh(mesh);
  return "\"triangles\": " + std::to_string(check.triangles) + ", \"open_edges\": " + std::to_string(check.open_edges) +
         ", \"nonmanifold_edges\": " + std::to_string(check.nonmanifold_edges) +
         ", \"nonmanifold_vertices\": " + std::to_string(check.nonmanifold_vertices) +
         ", \"area\": " + std::to_string(check.area) + ", \"volume\": " + std::to_string(check.volume);
}

void print(const std::string& program, double resolution, const Run& run) {
  std::cout << "{\"program\": \"" << program << "\", \"cell\": " << resolution << ", \"seconds\": [";
  for (std::size_t i = 0; i < run.seconds.size(); ++i) std::cout << (i > 0 ? ", " : "") << run.seconds[i];
  std::cout << "], " << checked(run.mesh) << "}" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Meshes one model with Outcrop and with OpenVDB, one thread; a line of JSON a run.", "outcrop_race"};
  std::string model_file, expression_file, mesh_file;
  std::vector<double> cells{0.4, 0.2, 0.1, 0.05};
  int repetitions = 3, band = 1;
  app.add_option("--model", model_file, "Planes by block; default: made up")->envname("OUTCROP_BENCH_MODEL");
  app.add_option("--cells", cells, "Edges of the cells, metres: 25.6 / 8 over a power of two")->capture_default_str();
  app.add_option("--repetitions", repetitions, "Of each; the median is printed")->capture_default_str();
  app.add_option("--band", band, "Voxels to each side of the surface that OpenVDB's grid holds at least")
      ->capture_default_str();
  app.add_option("--write-expression", expression_file, "Only write the model as fidget's text, in units of 12.8 m");
  app.add_option("--check", mesh_file, "Only check this mesh");
  CLI11_PARSE(app, argc, argv);

  try {
    if (!mesh_file.empty()) {
      std::cout << "{" << checked(outcrop::read_mesh(mesh_file)) << "}\n";
      return 0;
    }
    const race::Model model = model_file.empty() ? race::make_model(1) : race::read_model(model_file);
    if (!expression_file.empty()) {
      std::ofstream out(expression_file);
      race::write_expression(out, model);
      return out.flush() ? 0 : 1;
    }
    const outcrop::ThreadLimit one_thread(1);
    const outcrop::FieldPtr field = race::field_of(model);
    std::cout << "{\"openvdb\": \"" << race::openvdb_version() << "\"}\n";
    for (const double cell : cells) {
      print("Outcrop without normals", cell, median(repetitions, [&] { return by_outcrop(*field, cell, false); }));
      print("Outcrop", cell, median(repetitions, [&] { return by_outcrop(*field, cell, true); }));
      print("OpenVDB", cell, median(repetitions, [&] { return by_openvdb(*field, cell, band); }));
    }
  } catch (const std::exception& error) {
    std::cerr << "outcrop_race: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

/// polygonize: a scene, a grid or a mesh in, a clean mesh out.
#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <map>
#include <string>

#include "cli.h"
#include "outcrop/amplify/run_polygonize.h"

int main(int argc, char** argv) {
  CLI::App app{"Meshes a field: a scene of solids, a voxel grid or a closed mesh.", "polygonize"};
  outcrop::PolygonizeRun run;
  outcrop::cli::Options options;

  app.add_option("INPUT", run.input, "A scene (.json), a level set (.vdb) or a closed mesh (.ply, .obj, .stl)")->required();
  outcrop::cli::add_output_options(app, run.meshes, run.previews, run.width, run.height);
  app.add_option("--resolution", run.resolution, "Edge of the cells, metres; default: the region's longest side / 128");
  app.add_option("--tolerance", run.tolerance,
                 "Metres that triangles may lie off the surface where cells are wider than the resolution; 0: none is")
      ->capture_default_str();
  app.add_option("--triangles", run.triangles, "About as many triangles as are wanted, instead of a tolerance");
  app.add_flag("--crisp", run.crisp, "Put vertices on the creases that run through the finest cells");
  std::optional<std::array<double, 6>> region;
  app.add_option("--region", region, "X0 Y0 Z0 X1 Y1 Z1, metres; default: the scene's, else where the solid is");

  const std::map<std::string, outcrop::Border> borders{{"open", outcrop::Border::Open}, {"closed", outcrop::Border::Closed}};
  std::string border = "closed";
  app.add_option("--border", border, "Where the solid leaves the region: closed (walls) or open")
      ->check(CLI::IsMember({"open", "closed"}))
      ->capture_default_str();
  const std::map<std::string, outcrop::Parts> kept{
      {"all", outcrop::Parts::All}, {"grounded", outcrop::Parts::Grounded}, {"largest", outcrop::Parts::Largest}};
  std::string parts = "all";
  app.add_option("--parts", parts, "Parts to keep: all, grounded (those that reach the region's floor) or largest")
      ->check(CLI::IsMember({"all", "grounded", "largest"}))
      ->capture_default_str();
  app.add_flag("--keep-voids", run.keep_voids, "Keep closed voids inside the solid");

  outcrop::cli::add_run_options(app, run.threads, run.memory_limit_gib, run.dry_run, options,
                                "cells, triangles, memory");

  app.footer("A scene in one line: {\"field\": {\"difference\": {\"a\": {\"box\": {}}, \"b\": {\"sphere\": {\"radius\": 1.2}}}}}\n"
             "  polygonize scene.json -o solid.ply --preview solid.png\n"
             "All kinds of fields and all file formats: docs/formats.md.");

  return outcrop::cli::run(app, argc, argv, options, [&](const outcrop::Task& task) {
    run.border = borders.at(border);
    run.parts = kept.at(parts);
    if (region) run.region = outcrop::Box{{(*region)[0], (*region)[1], (*region)[2]}, {(*region)[3], (*region)[4], (*region)[5]}};
    const auto notify = [&](const std::string& line) { outcrop::cli::notify(app, options, line); };
    std::cout << outcrop::run_polygonize(run, notify, task);
  });
}

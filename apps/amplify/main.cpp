/// amplify: a heightmap in, rocky terrain out.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "cli.h"
#include "outcrop/amplify/run_amplify.h"
#include "outcrop/amplify/strata_file.h"

namespace {

/// The command line in one piece, for the report.
std::string command_text(int argc, char** argv) {
  std::string text = "amplify";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain = !word.empty() && word.find_first_of(" \t\"'\\$*?") == std::string::npos;
    text += plain ? " " + word : " '" + word + "'";
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Amplifies a heightmap with fractured rock: a mesh, a ray-traced picture, a report.", "amplify"};
  outcrop::AmplifyRun run;
  outcrop::cli::Options options;

  app.add_option("HEIGHTMAP", run.heightmap, "Elevations: EXR, TIFF, GeoTIFF, PNG or SRTM .hgt; --tile-report does without");
  app.add_option("--strata", run.strata, "Description of the rock, strata.json");
  outcrop::cli::add_output_options(app, run.meshes, run.previews, run.width, run.height);
  app.add_flag_callback(
         "--list-types", [] { throw CLI::CallForVersion(outcrop::block_types_json(), 0); },
         "Print the block types as a strata file to copy from, and exit")
      ->trigger_on_parse();
  app.add_option("--report", run.report, "Report to write, JSON");
  app.add_option("--tile-report", run.tile_reports, "Rock in numbers, a page for each material: .html, .json; may be repeated")
      ->allow_extra_args(false);

  app.add_option("--cell-size", run.heights.cell_size, "Metres between samples; default: the file's, else 1");
  app.add_option("--height-scale", run.heights.height_scale, "Elevation = sample * scale + offset")->capture_default_str();
  app.add_option("--height-offset", run.heights.height_offset, "Metres")->capture_default_str();
  bool bilinear = false;
  app.add_flag("--bilinear", bilinear, "Interpolate samples bilinearly instead of smoothly");
  std::string nodata;
  app.add_option("--nodata", nodata, "What to do where data are missing: hole or fill; default: the strata file's")
      ->check(CLI::IsMember({"hole", "fill"}));

  app.add_option("--region", run.region,
                 "X0 Y0 X1 Y1 in map coordinates where the heightmap has some, else metres from its south-west corner; "
                 "default: everything, or the steepest part of a large terrain");
  app.add_option("--resolution", run.resolution, "Edge of the mesh's cells, metres; default: a twelfth of a block");
  app.add_option("--tolerance", run.tolerance,
                 "Metres that triangles may lie off the surface where cells are wider than the resolution; 0: none is; "
                 "default: a tenth of the resolution where less than half of the ground is steep, else 0");
  app.add_option("--triangles", run.triangles, "About as many triangles as are wanted, instead of a tolerance");
  app.add_flag("--crisp", run.crisp, "Put vertices on the creases that run through the finest cells");
  app.add_flag("--solid", run.solid, "Close the sheet with walls and a floor");
  app.add_option("--seed", run.seed, "Same seed, same rock")->capture_default_str();

  app.add_option("--camera", run.camera,
                 "X Y Z TX TY TZ: position and target in the mesh's coordinates, metres from the south-west corner; "
                 "default: frames the steepest part");
  app.add_option("--fov-deg", run.fov_deg, "Vertical field of view of the camera")->capture_default_str();

  outcrop::cli::add_run_options(app, run.threads, run.memory_limit_gib, run.dry_run, options,
                                "blocks, cells, triangles, seconds, bytes");

  app.footer("Without -o, --preview and --report it writes HEIGHTMAP_rock.ply and HEIGHTMAP_rock.png to this folder.\n"
             "  amplify cliff.tif --dry-run\n"
             "  amplify cliff.tif --strata data/strata/limestone.json --region 0 0 60 60 -o rock.ply --preview rock.png\n"
             "All keys of strata.json and all file formats: docs/formats.md.");

  return outcrop::cli::run(app, argc, argv, options, [&](const outcrop::Task& task) {
    if (bilinear) run.interpolation = outcrop::Interpolation::Bilinear;
    if (!nodata.empty()) run.nodata = nodata == "hole" ? outcrop::NodataPolicy::Hole : outcrop::NodataPolicy::Fill;
    run.command = command_text(argc, argv);
    const auto notify = [&](const std::string& line) { outcrop::cli::notify(app, options, line); };
    std::cout << outcrop::run_amplify(run, notify, task);
  });
}

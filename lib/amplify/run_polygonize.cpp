#include "outcrop/amplify/run_polygonize.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "clip_mesh.h"
#include "outcrop/amplify/report.h"
#include "outcrop/amplify/scene_file.h"
#include "outcrop/core/parallel.h"
#include "outcrop/implicit/grid_field.h"
#include "outcrop/mesh/write_mesh.h"
#include "outcrop/render/camera.h"
#include "outputs.h"

namespace outcrop {
namespace {

constexpr double kFieldOfView = radians(35.0);
const Vec3 kViewFrom(0.9, -1.2, 0.8);          // A corner view from above.
const Vec3 kSun(-0.45, -0.6, 0.8);

/// The scene that the input is: a lone grid or mesh counts as a scene of one field.
Scene read_input(const PolygonizeRun& run, const Task& task) {
  std::string extension = run.input.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
  if (extension == ".json") return read_scene(run.input, task);
  Scene scene;
  if (extension == ".vdb") {
    scene.field = read_vdb(run.input, task);
  } else if (extension == ".ply" || extension == ".obj" || extension == ".stl") {
    MeshField mesh = mesh_field(run.input, run.resolution.value_or(0.0), task);
    scene.field = std::move(mesh.field);
    if (!mesh.note.empty()) scene.notes.push_back(std::move(mesh.note));
  } else {
    const std::string got = extension.empty() ? "a name without extension" : extension;
    throw InputError(run.input.string() + ": expected a scene (.json), a grid (.vdb) or a mesh (.ply, .obj, .stl), got " + got);
  }
  scene.region = default_region(*scene.field);
  scene.label_names = {"rock"};
  scene.label_colours = {Vec3f(0.42f, 0.37f, 0.31f)};
  return scene;
}

PolygonizeOptions mesh_options(const PolygonizeRun& run, const Scene& scene) {
  const std::optional<Box> region = run.region ? run.region : scene.region;
  if (!region)
    throw InputError(run.input.string() + ": expected a field of known extent, or \"region\" in the scene, or --region");
  for (int axis = 0; axis < 3; ++axis)
    require(region->lo[axis] < region->hi[axis], "--region", "X0 Y0 Z0 below X1 Y1 Z1",
            number_text(region->lo[axis]) + " " + number_text(region->hi[axis]));
  const Vec3 size = region->size();
  const double longest = std::max({size.x, size.y, size.z});
  const double resolution = run.resolution ? *run.resolution : scene.resolution.value_or(longest / kDefaultCells);
  require(resolution >= kLeastLength && resolution <= longest, "--resolution",
          number_text(kLeastLength) + " m to " + number_text(longest) + " m, the region's longest side", resolution);
  // In the scene's own coordinates, unless floats are too coarse for its cells there.
  const Vec3 far = glm::max(glm::abs(region->lo), glm::abs(region->hi));
  const bool near = std::max({far.x, far.y, far.z}) <= kExactCells * resolution;
  return {.region = *region,
          .origin = near ? std::optional(Vec3(0.0)) : std::nullopt,
          .resolution = resolution,
          .tolerance = run.tolerance,
          .triangles = run.triangles,
          .border = run.border,
          .parts = run.parts,
          .keep_voids = run.keep_voids,
          .memory_limit = memory_limit_bytes(run.memory_limit_gib)};
}

Preview preview(const PolygonizeRun& run, const Scene& scene, const PolygonizeOptions& mesh, const Task& task) {
  PreviewOptions options;
  options.width = run.width;
  options.height = run.height;
  options.region = mesh.region;
  options.detail = mesh.resolution;
  options.colours = scene.label_colours;
  options.camera = frame_box(mesh.region, -kViewFrom, kFieldOfView, double(run.width) / run.height);
  options.sun = kSun;
  return render_preview(*scene.field, options, task);
}

}  // namespace

std::string run_polygonize(const PolygonizeRun& run, const Notify& notify, const Task& task) {
  require(run.threads >= 0, "--threads", "0 (all cores) or more", run.threads);
  require(run.dry_run || !run.meshes.empty() || !run.previews.empty(), "--output", "at least one mesh or --preview", "none");
  check_size(run.width, run.height);
  check_outputs({run.meshes, run.previews, {}}, {run.input});
  const ThreadLimit limit(run.threads);
  const auto written = [&](const std::filesystem::path& path, const std::string& what) {
    if (notify) notify("wrote " + path.string() + ": " + what);
  };

  task.begin("reading");
  const Scene scene = read_input(run, task);
  const PolygonizeOptions options = mesh_options(run, scene);
  // Once the input has been found usable: a refusal is one line and stands alone.
  const auto accepted = [&] {
    for (const std::string& note : scene.notes)
      if (notify) notify(note);
  };
  if (run.dry_run) {
    const PolygonizeEstimate estimate = estimate_polygonize(*scene.field, options, task);
    accepted();
    const bool level_set = wants_level_set({run.meshes, {}, {}});
    const double bytes = static_cast<double>(peak_memory() + estimate.bytes) +
                         (level_set ? kLevelSetBytesACell * static_cast<double>(estimate.cells) : 0.0);
    return "resolution " + number_text(options.resolution) + " m\ncells      " + count_text(double(estimate.cells)) +
           "\ntriangles  " + count_text(double(estimate.triangles)) + "\nmemory     " + byte_text(bytes) + "\n";
  }
  if (!run.meshes.empty()) {
    // A level set holds the distance to the closed mesh, and an open one is that without its walls: one mesh for both.
    const bool distance = wants_level_set({run.meshes, {}, {}}) && !run.keep_voids;
    PolygonizeOptions made = options;
    if (distance) made.border = Border::Closed;
    PolygonizeResult result = polygonize(*scene.field, made, task);
    TriangleMesh solid = std::move(result.mesh);
    accepted();
    const bool open = distance && options.border == Border::Open;
    const TriangleMesh mesh = rebased(open ? without_walls(solid, result.statistics.extent) : solid, Vec3(0.0));
    solid = rebased(std::move(solid), Vec3(0.0));
    if (mesh.triangles.empty() && notify)
      notify("cells of " + number_text(options.resolution) + " m find no surface in the region: the mesh is empty");
    const MeshMetadata metadata{{"outcrop " + std::string(version()) + " polygonize " + run.input.filename().string(),
                                 "resolution " + number_text(options.resolution, 9) + " m"},
                                scene.label_names,
                                scene.label_colours};
    for (const auto& path : run.meshes) {
      if (is_vdb(path)) continue;
      write_mesh(path, mesh, metadata, task);
      written(path, count_text(double(mesh.triangles.size())) + " triangles");
    }
    for (const auto& path : run.meshes) {
      if (!is_vdb(path)) continue;
      // The distance to a mesh knows no voids: to keep them, the field is written as it is, with all its parts.
      if (run.keep_voids)
        write_vdb(path, *scene.field, options.region, options.resolution, Vec3(0.0), kVdbBand, task);
      else
        write_level_set(path, solid, options.resolution, task);
      written(path, "a level set");
    }
  }
  if (run.meshes.empty()) accepted();
  if (!run.previews.empty()) {
    const Preview picture = preview(run, scene, options, task);
    for (const auto& path : run.previews) {
      write_preview(path, picture);
      written(path, std::to_string(run.width) + " x " + std::to_string(run.height) + " pixels");
    }
  }
  return {};
}

}  // namespace outcrop

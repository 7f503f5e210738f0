/// From a scene, a mesh or a voxel grid to a mesh: what the program `polygonize` does once its command line is read.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "outcrop/amplify/run_amplify.h"
#include "outcrop/core/box.h"
#include "outcrop/core/task.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop {

struct PolygonizeRun {
  std::filesystem::path input;                  ///< A scene (.json), a grid (.vdb) or a closed mesh (.ply, .obj, .stl).
  std::vector<std::filesystem::path> meshes;    ///< .ply, .obj, .stl, .vdb
  std::vector<std::filesystem::path> previews;  ///< .png, .exr
  std::optional<double> resolution;             ///< Metres; missing: the scene's, else the region's longest side / 128.
  double tolerance = 0.0;     ///< Metres off the surface where cells are not finest; 0: all are.
  std::size_t triangles = 0;  ///< About as many as are wanted; 0: as it comes.
  bool crisp = false;         ///< Vertices on creases.
  std::optional<Box> region;                    ///< Missing: the scene's, else where the solid is.
  Border border = Border::Closed;
  Parts parts = Parts::All;
  bool keep_voids = false;
  int threads = 0;                              ///< 0: all cores.
  double memory_limit_gib = 0.0;                ///< 0: half of the machine's memory.
  bool dry_run = false;
  int width = 1280, height = 720;               ///< Of previews, pixels.
};

/// Reads, meshes, renders and writes.
///
/// @return what belongs on stdout: the expectations of a dry run, else nothing.
/// @throws InputError, ParameterError, SystemError, Cancelled; outputs appear whole or not at all.
[[nodiscard]] std::string run_polygonize(const PolygonizeRun& run, const Notify& notify = {}, const Task& task = {});

}  // namespace outcrop

/// Ray-traced pictures of a field, without a mesh.
#pragma once

#include <cstddef>
#include <vector>

#include "outcrop/core/image.h"
#include "outcrop/core/rng.h"
#include "outcrop/core/task.h"
#include "outcrop/implicit/field.h"
#include "outcrop/render/camera.h"

namespace outcrop {

struct PreviewOptions {
  int width = 1280, height = 720;   ///< Pixels, 1 … 16384.
  Camera camera;
  Box region;                       ///< What is drawn, world metres; the field is cut off at its sides.
  double detail = 0.25;             ///< Metres: leaf boxes of the hierarchy shrink to this; match the mesh's cell.
  Vec3 sun{-0.5, -0.4, 0.75};       ///< Towards the sun, not zero.
  int occlusion_samples = 8;        ///< Sky rays a pixel for ambient occlusion, ≥ 0, shared by its pixel_samples.
  int pixel_samples = 4;            ///< Rays a pixel against jagged edges, ≥ 1.
  std::vector<Vec3f> colours;       ///< Linear albedo by label; missing ones are grey.
  Seed seed = 1;
};

struct PreviewStatistics {
  std::size_t leaves = 0, rays = 0, steps = 0;
  std::size_t capped_rays = 0;      ///< Rays that reached the step bound and fell back to fine steps.
};

struct Preview {
  Image beauty;    ///< 3 channels, display-referred 0..1 sRGB for .png.
  Image layers;    ///< "R","G","B" (linear), "A", "depth.Z", "normal.X/Y/Z", "material.ID": for .exr.
  PreviewStatistics statistics;
};

/// Sphere-traces the field inside an Embree hierarchy of boxes that `bound` could not exclude, in each of which the
/// field is narrowed. One sun with shadows, sky ambient occlusion, colour by label. The same bytes for any number of threads.
/// @throws ParameterError (naming what), Cancelled.
[[nodiscard]] Preview render_preview(const Field& field, const PreviewOptions& options, const Task& task = {});

}  // namespace outcrop

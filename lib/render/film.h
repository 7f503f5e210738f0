/// Pixels on their way to a picture.
#pragma once

#include <vector>

#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"
#include "outcrop/render/preview.h"

namespace outcrop::render {

/// What the rays of one pixel brought back.
struct Pixel {
  Vec3f sunlit{0.0f};      ///< Light of the sun that rock reflects, times its share of the pixel.
  Vec3f albedo{0.0f};      ///< Mean over the rays that hit rock.
  Vec3f ambient{0.0f};     ///< Mean radiance of sky and rock around, weighted by cosine, over the rays that hit.
  Vec3f background{0.0f};  ///< Sky, times its share of the pixel.
  float coverage = 0.0f;   ///< Share of the rays that hit rock.
  float depth = 0.0f;      ///< Metres along the first ray that hit; so are the rest.
  Vec3 position{0.0};
  Vec3 normal{0.0};
  Label label = 0;
};

/// A row-major picture of them.
struct Film {
  int width = 0, height = 0;
  double spread = 0.0;  ///< Metres of pixel width a metre of depth.
  std::vector<Pixel> pixels;
};

/// The ambient light smoothed over neighbours on the same surface: those whose normal agrees and that lie in the
/// pixel's tangent plane. Few rays a pixel are grainy; their mean over a patch of a plane is not.
[[nodiscard]] std::vector<Vec3f> smooth_ambient(const Film& film, const Task& task);

/// Both pictures. Fills all but the statistics.
[[nodiscard]] Preview develop(const Film& film, const Task& task);

}  // namespace outcrop::render

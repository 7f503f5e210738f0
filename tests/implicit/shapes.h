/// Polytopes and reliefs for tests.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop::test {

/// `count` planes around the centre at 0.6 to 1 times `radius`: a bounded block for count ≥ 12 or so.
[[nodiscard]] inline std::vector<Plane> random_planes(Seed seed, int count, double radius,
                                                      const Vec3& centre = Vec3(0.0)) {
  Rng rng(seed, "test planes");
  std::vector<Plane> planes;
  for (int i = 0; i < count; ++i) {
    const Vec3 normal = rng.direction();
    const double distance = radius * rng.uniform(0.6, 1.0);
    planes.push_back({normal, -glm::dot(normal, centre) - distance});
  }
  return planes;
}

/// The six sides of a cube.
[[nodiscard]] inline std::vector<Plane> cube_planes(double half, const Vec3& centre = Vec3(0.0)) {
  std::vector<Plane> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vec3 normal{0.0};
      normal[axis] = sign;
      planes.push_back({normal, -glm::dot(normal, centre) - half});
    }
  return planes;
}

[[nodiscard]] inline Image grey_image(int width, int height) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = 1;
  image.channel_names = {"Y"};
  image.pixels.assign(static_cast<std::size_t>(width) * height, 0.0f);
  return image;
}

/// White noise: as steep as a relief of this many pixels can be.
[[nodiscard]] inline ReliefPtr noise_relief(Seed seed, int width, int height, double period) {
  Image image = grey_image(width, height);
  Rng rng(seed, "test relief");
  for (float& pixel : image.pixels) pixel = static_cast<float>(rng.uniform());
  return std::make_shared<const Relief>(image, period);
}

/// Every pixel the same: carves `1 − level` everywhere.
[[nodiscard]] inline ReliefPtr flat_relief(float level, double period = 1.0) {
  Image image = grey_image(4, 4);
  for (float& pixel : image.pixels) pixel = level;
  return std::make_shared<const Relief>(image, period);
}

}  // namespace outcrop::test

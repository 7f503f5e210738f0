/// Pinhole cameras.
#pragma once

#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"

namespace outcrop {

struct Camera {
  Vec3 position{0.0};
  Vec3 target{0, 1, 0};
  double field_of_view = 0.7;  ///< Vertical, radians, (0, π).
};

}  // namespace outcrop

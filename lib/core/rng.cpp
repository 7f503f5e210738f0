#include "outcrop/core/rng.h"

#include <cmath>

namespace outcrop {

Vec3 Rng::direction() noexcept {
  // Marsaglia 1972: only a square root, which is exact everywhere; sine and cosine differ between machines.
  for (;;) {
    const double x = uniform(-1.0, 1.0);
    const double y = uniform(-1.0, 1.0);
    const double s = x * x + y * y;
    if (s >= 1.0) continue;
    const double r = 2.0 * std::sqrt(1.0 - s);
    return {x * r, y * r, 1.0 - 2.0 * s};
  }
}

}  // namespace outcrop

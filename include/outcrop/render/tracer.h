/// Rays against a field.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>

#include "outcrop/core/box.h"
#include "outcrop/core/task.h"
#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"

namespace outcrop {

/// A ray with a thickness: nothing much thinner than `width(t)` is looked for.
struct Ray {
  Vec3 origin{0.0};
  Vec3 direction{0, 1, 0};  ///< Unit length.
  double t_max = std::numeric_limits<double>::infinity();
  double base_width = 0.0;  ///< Metres at the origin, ≥ 0.
  double spread = 1e-3;     ///< Metres of width a metre of way, ≥ 0.

  [[nodiscard]] Vec3 at(double t) const noexcept { return origin + t * direction; }
  [[nodiscard]] double width(double t) const noexcept { return base_width + spread * t; }
};

/// Where a ray meets rock.
struct RayHit {
  double t = 0.0;
  Vec3 position{0.0};      ///< On the air's side of the surface, by less than a tenth of the ray's width.
  Vec3 normal{0, 0, 1};    ///< Unit, out of the rock.
  Label label = 0;
  bool cut = false;        ///< On the side of the region, inside rock, rather than on the field's surface.
};

/// What tracing cost. Summed by the caller, one per thread or tile.
struct RayCounters {
  std::size_t rays = 0;
  std::size_t steps = 0;   ///< Field values.
  std::size_t capped = 0;  ///< Rays that needed more than 256 steps in a leaf and went on with steps of their width.
};

struct TracerOptions {
  Box region;                ///< The field is cut off at its sides.
  double detail = 0.25;      ///< Metres, > 0; match the mesh's cell.
  double leaf_details = 1.0; ///< Leaves are about so many details wide …
  double leaf_widths = 6.0;  ///< … but not below this many ray widths, as seen from `eye`.
  Vec3 eye{0.0};
  double spread = 1e-3;      ///< Of the rays that leave the eye.
  Vec3 view{0, 1, 0};        ///< Unit; leaves outside the cone around it are coarser.
  double view_angle = 0.5;   ///< Half the cone's angle, radians.
  std::size_t max_leaves = 1'200'000;  ///< About: near it, leaves stay larger. Some 1.7 kB each.
};

/// The field inside a region, ready for rays: an octree of boxes that `bound` could not exclude, each with its narrowed
/// field, in an Embree hierarchy.
///
/// Each leaf is searched by sphere tracing with the narrowed field's own Lipschitz constant. What a leaf answers depends
/// on the ray and the leaf alone, so that hits do not depend on the order of traversal.
class Tracer {
 public:
  /// @param field  Owned by a shared_ptr, as all fields.
  /// @throws ParameterError, Cancelled; SystemError when Embree runs out of memory.
  Tracer(const Field& field, const TracerOptions& options, const Task& task = {});
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// The first rock along the ray.
  [[nodiscard]] std::optional<RayHit> closest(const Ray& ray, RayCounters& counters) const noexcept;
  /// Whether there is any.
  [[nodiscard]] bool blocked(const Ray& ray, RayCounters& counters) const noexcept;
  [[nodiscard]] std::size_t leaf_count() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace outcrop

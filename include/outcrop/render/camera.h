/// Pinhole cameras, and where to put them.
#pragma once

#include <optional>

#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"

namespace outcrop {

struct Camera {
  Vec3 position{0.0};
  Vec3 target{0, 1, 0};
  double field_of_view = 0.7;  ///< Vertical, radians, (0, π).
};

/// The camera's axes in the world: unit vectors, up = right × forward, towards z (y when looking along z).
struct CameraAxes {
  Vec3 right, up, forward;
};

/// @throws ParameterError unless position and target are finite and apart and the field of view is in (0, π).
[[nodiscard]] CameraAxes camera_axes(const Camera& camera);

/// The camera that looks along `view_direction` at the middle of `focus`, just so far away that the whole box is in the
/// picture.
/// @param view_direction  Not zero, any length. @param aspect  Width over height, > 0.
/// @throws ParameterError when an argument is outside its bound or the box is empty.
[[nodiscard]] Camera frame_box(const Box& focus, const Vec3& view_direction, double field_of_view, double aspect);

/// The camera that sees most of the surface in `focus` from about `from_direction` (from the focus towards the camera).
///
/// Tries directions around it, farther to the sides and higher up, and nearer places when all of those are blocked (the
/// other wall of a canyon), and takes the one from which most of the surface in the box is in the picture and not
/// hidden by rock, small turns first. The camera is always in the air: in the worst case straight above.
/// @param drawn  Rock outside of this box is not in the picture and hides nothing: pass the preview's region,
///               which also saves looking at rock far away.
/// @throws ParameterError as frame_box. Cost: a coarse Tracer, and at most 135 places with some 100 rays each.
[[nodiscard]] Camera framed(const Field& field, const Box& focus, const Vec3& from_direction, double field_of_view,
                            double aspect, const std::optional<Box>& drawn = std::nullopt);

}  // namespace outcrop

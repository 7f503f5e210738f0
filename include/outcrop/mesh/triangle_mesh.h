/// Indexed triangle meshes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"

namespace outcrop {

/// Counter-clockwise seen from the air. Positions are floats relative to `origin`, so that they stay exact far away.
struct TriangleMesh {
  Vec3 origin{0.0};  ///< World position of (0, 0, 0), metres.
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< Unit, one a vertex, or empty.
  std::vector<Label> labels;   ///< Material, one a vertex, or empty.
  std::vector<std::array<std::uint32_t, 3>> triangles;

  [[nodiscard]] Box bounds() const;  ///< World.
};

/// The same surface with positions relative to another origin: what writers and viewers need to see other coordinates.
/// Positions are rounded to float again; move no farther than floats can hold.
[[nodiscard]] TriangleMesh rebased(TriangleMesh mesh, const Vec3& origin);

}  // namespace outcrop

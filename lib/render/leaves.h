/// The boxes of a region that may hold surface.
#pragma once

#include <vector>

#include "outcrop/core/box.h"
#include "outcrop/core/task.h"
#include "outcrop/implicit/field.h"
#include "outcrop/render/tracer.h"

namespace outcrop::render {

/// A box, and the field narrowed to it. Leaves share faces and overlap by a hair, so that no ray slips between two.
struct Leaf {
  Box box;
  FieldPtr field;
  double lipschitz = 1.0;  ///< Of the narrowed field.
  Modulus modulus{1.0, 0.0};
};

/// The leaves of the region's octree: boxes whose bound contains 0, and boxes of rock that touch the region's sides.
///
/// In the same order for any number of threads. Cost: one bound and one narrow a node.
[[nodiscard]] std::vector<Leaf> build_leaves(const Field& field, const TracerOptions& options, const Task& task);

}  // namespace outcrop::render

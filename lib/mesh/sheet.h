/// The zero surface on a lattice, before anything is closed or left out.
#pragma once

#include "lattice.h"
#include "outcrop/core/task.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop::meshing {

/// The surface as a mesh whose origin is lattice.lo; it ends at the lattice's six sides, on them to the bit.
///
/// Fills statistics.cells and .evaluations. @throws ParameterError when the field's bound or narrowing contradict its
/// values, when there are more vertices than 32-bit indices; Cancelled.
[[nodiscard]] PolygonizeResult mesh_sheet(const Field& field, const Lattice& lattice, const PolygonizeOptions& options,
                                          const Task& task);

}  // namespace outcrop::meshing

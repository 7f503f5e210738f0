/// What stands where an elevation grid has no data.
#pragma once

#include <vector>

#include "outcrop/terrain/heightfield.h"

namespace outcrop::terrain {

/// The elevations with NaN samples replaced by a membrane hung on the rims of the data: no extremum of its own.
///
/// At least one sample must be valid. Cost: O(samples).
/// Method: Laplace's equation by one coarse-to-fine pass with Gauss-Seidel sweeps on every level (cascadic multigrid,
/// Bornemann and Deuflhard 1996).
[[nodiscard]] std::vector<float> filled_elevations(const ElevationGrid& grid);

/// Signed horizontal distance of every sample to the border between NaN and data, metres, > 0 where NaN.
///
/// The border runs half-way between a valid sample and an invalid one. Interpolated bilinearly it has Lipschitz
/// constant 1 (values are scaled down by at most 2 √2 where the plain distance is steeper). All samples are large and
/// negative when none is NaN. Cost: O(samples). Method: exact Euclidean distance transform by lower envelopes of
/// parabolas (Felzenszwalb and Huttenlocher 2012).
[[nodiscard]] std::vector<float> hole_distances(const ElevationGrid& grid);

}  // namespace outcrop::terrain

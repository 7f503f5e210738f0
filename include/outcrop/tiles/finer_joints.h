/// Blocks of blocks: rock that a finer tile's joints cut from its surface inwards.
#pragma once

#include "outcrop/implicit/field.h"

namespace outcrop {

/// max(rock, min(finer, rock + depth)): rock, cut by a finer rock's joints down to a depth below its surface.
///
/// `finer` is air in its joints and rock wherever else `rock` may be. What lies deeper than `depth` in the rock is
/// whole: `bound` says so without asking the finer rock. Labels: rock's. Lipschitz: the larger of the two. Cost of a
/// value: both.
/// @param depth  Metres, > 0.
/// @throws ParameterError.
[[nodiscard]] FieldPtr with_finer_joints(FieldPtr rock, FieldPtr finer, double depth);

}  // namespace outcrop

/// Blocks that end at the boundary of their stratum.
#pragma once

#include "outcrop/implicit/field.h"

namespace outcrop {

/// The crack along the boundary of a body of rock, half of it on each side.
struct BeddingJoint {
  double half_aperture = 0.0;   ///< Metres; < 0: the sides overlap, by no more than a millimetre.
  FieldPtr crack_floor;         ///< Below this surface the crack closes; null: nowhere.
  double closure_slope = 0.05;  ///< By so much on either side per metre below the floor, > 0.
};

/// max(rock, body + half gap): rock as far as its body (negative inside) reaches, less half of the crack along it.
///
/// Two bodies with a common boundary leave a crack of the aperture, closed at depth: no point is in the rock of both,
/// but for a millimetre where it is closed. Labels: rock's. Lipschitz: the larger of rock's and the cut's.
[[nodiscard]] FieldPtr bedded_rock(FieldPtr rock, FieldPtr body, BeddingJoint joint);

}  // namespace outcrop

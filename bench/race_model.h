/// The model of the race: a few blocks in a cube, small enough for every program, as a Field and as an expression.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "outcrop/core/rng.h"
#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop::race {

/// Half the edge of the cube around the origin that holds the model, metres.
inline constexpr double kHalf = 12.8;

/// The minimum over blocks of the smooth intersection of their planes, in order.
struct Model {
  double rounding = 0.25;  ///< R in metres.
  std::vector<std::vector<Plane>> blocks;
};

/// Reads N and R, then per block the number of planes and, per plane, nx ny nz d in metres.
/// @throws InputError when the file is no such model.
[[nodiscard]] Model read_model(const std::string& path);

/// A hundred blocks of twenty planes around jittered seeds: like the model that is read, for a clone without it.
[[nodiscard]] Model make_model(Seed seed);

[[nodiscard]] FieldPtr field_of(const Model& model);

/// Writes the field, in units of kHalf, as fidget's text: one line an operation, `name operation arguments`.
///
/// smax(a, b) = max(a, b) + max(R − |a − b|, 0)³ / (6 R²): as few operations as the definition allows. The union is a
/// balanced tree of minima.
void write_expression(std::ostream& out, const Model& model);

}  // namespace outcrop::race

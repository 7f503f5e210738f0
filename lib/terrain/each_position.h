/// Batches over maps.
#pragma once

#include <cstddef>
#include <span>

namespace outcrop::terrain {

/// out[i] = evaluate(x[i], y[i]). Where positions come back after a number of others, as in the layers of a lattice, what
/// was computed is taken again, so that results do not depend on the batch.
template <class Value, class Evaluate>
void each_position(std::span<const double> x, std::span<const double> y, std::span<Value> out, Evaluate&& evaluate) {
  std::size_t period = 1;
  while (period < x.size() && (x[period] != x[0] || y[period] != y[0])) ++period;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool again = i >= period && x[i] == x[i - period] && y[i] == y[i - period];
    out[i] = again ? out[i - period] : evaluate(x[i], y[i]);
  }
}

}  // namespace outcrop::terrain

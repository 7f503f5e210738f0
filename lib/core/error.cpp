#include "outcrop/core/error.h"

#include <algorithm>
#include <charconv>
#include <vector>

namespace outcrop {

namespace {

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Edit distance in which swapping two neighbours counts one, as the commonest slip of the hand.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

}  // namespace

void require(bool holds, std::string_view name, std::string_view bound, double value) {
  if (!holds) require(false, name, bound, shortest(value));
}

void require(bool holds, std::string_view name, std::string_view bound, std::string_view value) {
  if (holds) return;
  throw ParameterError(std::string(name).append(": expected ").append(bound).append(", got ").append(value));
}

std::string_view nearest_name(std::string_view name, const std::string_view* known, std::size_t count) {
  std::string_view nearest;
  std::size_t least = name.size();  // a word in which every letter is wrong was not meant
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t longer = std::max(name.size(), known[i].size());
    const std::size_t allowed = (longer + 2) / 3;
    const std::size_t shorter = std::min(name.size(), known[i].size());
    if (longer - shorter > allowed) continue;
    const std::size_t distance = edit_distance(name, known[i]);
    if (distance <= allowed && distance < least) {
      least = distance;
      nearest = known[i];
    }
  }
  return nearest;
}

}  // namespace outcrop

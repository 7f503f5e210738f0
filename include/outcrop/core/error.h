/// What the library throws. `lib/` never prints, exits or returns an error code.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace outcrop {

/// The input cannot be used: `path:line:column: expected …, got …`. Programs exit with 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An option is outside its bound; names parameter, bound and value. Programs exit with 2.
class ParameterError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// The machine failed: a disk is full, a file cannot be replaced. Programs exit with 1.
class SystemError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The caller's stop token was triggered; nothing was written. Programs exit with 130.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

/// Throws ParameterError `name: expected <bound>, got <value>` unless `holds`.
void require(bool holds, std::string_view name, std::string_view bound, double value);
void require(bool holds, std::string_view name, std::string_view bound, std::string_view value);

/// The known name nearest to `name` by edit distance, or "" when none is near enough to be meant.
/// Cost: O(|name| |k|) a known name k.
[[nodiscard]] std::string_view nearest_name(std::string_view name, const std::string_view* known, std::size_t count);

}  // namespace outcrop

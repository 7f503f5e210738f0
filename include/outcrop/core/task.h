/// What long work needs from its caller: a way to be stopped and a way to be watched.
#pragma once

#include <cstddef>
#include <stop_token>
#include <string_view>

#include "outcrop/core/error.h"

namespace outcrop {

/// Watches long work. Calls may come from any thread; implementations synchronise.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage begins; `total` units of work are expected, 0 when unknown.
  virtual void begin(std::string_view stage, std::size_t total) = 0;
  /// `count` units of the current stage are done.
  virtual void advance(std::size_t count) = 0;
};

/// Passed as the last argument, `const Task& task = {}`, of every function that may take long.
struct Task {
  std::stop_token stop;
  Progress* progress = nullptr;  ///< Borrowed; may be null.

  void begin(std::string_view stage, std::size_t total = 0) const {
    if (progress) progress->begin(stage, total);
  }
  void advance(std::size_t count = 1) const {
    if (progress) progress->advance(count);
  }
  /// @throws Cancelled once a stop was requested.
  void check() const {
    if (stop.stop_requested()) throw Cancelled();
  }
};

}  // namespace outcrop

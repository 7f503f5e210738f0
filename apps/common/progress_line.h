/// Progress on stderr.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

#include "outcrop/core/task.h"

namespace outcrop::cli {

/// Shows stage and percentage: on a terminal in one line that is written over, else a line a stage and one each while.
class ProgressLine final : public Progress {
 public:
  ProgressLine(std::string program, bool terminal);
  /// Leaves the terminal's line empty.
  ~ProgressLine() override;

  void begin(std::string_view stage, std::size_t total) override;
  void advance(std::size_t count) override;

 private:
  using Clock = std::chrono::steady_clock;

  void show();

  const std::string program_;
  const bool terminal_;
  std::atomic<std::size_t> done_ = 0;
  std::atomic<Clock::rep> next_ = 0;
  std::mutex mutex_;  // guards what follows, and stderr
  std::string stage_;
  std::size_t total_ = 0;
};

}  // namespace outcrop::cli

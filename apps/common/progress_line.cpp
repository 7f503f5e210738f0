#include "progress_line.h"

#include <algorithm>
#include <iostream>

namespace outcrop::cli {

namespace {

constexpr std::chrono::milliseconds kTerminalPause{100};
constexpr std::chrono::seconds kLogPause{5};
constexpr const char* kEraseLine = "\x1b[K";

}  // namespace

ProgressLine::ProgressLine(std::string program, bool terminal) : program_(std::move(program)), terminal_(terminal) {}

ProgressLine::~ProgressLine() {
  if (terminal_) std::cerr << kEraseLine << std::flush;
}

void ProgressLine::begin(std::string_view stage, std::size_t total) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  total_ = total;
  done_ = 0;
  show();
}

void ProgressLine::advance(std::size_t count) {
  done_ += count;
  if (Clock::now().time_since_epoch().count() < next_) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && Clock::now().time_since_epoch().count() >= next_) show();
}

void ProgressLine::show() {
  std::string text = program_ + ": " + stage_;
  if (total_ > 0 && done_ > 0) text += " " + std::to_string(100 * std::min<std::size_t>(done_, total_) / total_) + " %";
  // The cursor goes back to the line's start, so that a message that comes between stands alone.
  std::cerr << (terminal_ ? kEraseLine + text + "\r" : text + "\n") << std::flush;
  const auto next = Clock::now() + (terminal_ ? Clock::duration(kTerminalPause) : Clock::duration(kLogPause));
  next_ = next.time_since_epoch().count();
}

}  // namespace outcrop::cli

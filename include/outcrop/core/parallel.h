/// The only door to threads. One thread or sixteen give the same bytes: items are independent and results keep their index.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "outcrop/core/task.h"

namespace outcrop {

/// Calls `body(i)` for i in [0, count), on as many threads as the current ThreadLimit allows.
///
/// An exception from `body` stops the rest and is rethrown to the caller.
/// @throws Cancelled when `task.stop` is triggered; it is looked at between items.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, const Task& task = {});

/// The values `f(i)` for i in [0, count), in order.
template <class F>
[[nodiscard]] auto parallel_map(std::size_t count, F&& f, const Task& task = {}) {
  std::vector<decltype(f(std::size_t{}))> results(count);
  parallel_for(count, [&](std::size_t i) { results[i] = f(i); }, task);
  return results;
}

/// Limits parallel_for to `threads` threads while it lives; 0 means all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

/// Threads that parallel_for may use now, at least 1.
[[nodiscard]] int thread_count();

}  // namespace outcrop

#include "outcrop/core/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

#include "outcrop/core/error.h"

namespace outcrop {

namespace {

// Runs of items a thread takes at once: small enough that the last ones even out, large enough to hide the scheduler.
constexpr std::size_t kRunsPerThread = 64;

}  // namespace

struct ThreadLimit::Control {
  // Made in its place: TBB knows a control by its address, so a copy limits nothing.
  explicit Control(std::size_t threads) : control(tbb::global_control::max_allowed_parallelism, threads) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
  require(threads >= 0, "threads", "0 for all cores, or more", threads);
  if (threads == 0) return;
  control_ = std::make_unique<Control>(static_cast<std::size_t>(threads));
}

ThreadLimit::~ThreadLimit() = default;

int thread_count() {
  return static_cast<int>(
      std::max<std::size_t>(1, tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, const Task& task) {
  task.check();
  const int threads = thread_count();
  if (threads == 1 || count < 2) {
    for (std::size_t i = 0; i < count; ++i) {
      task.check();
      body(i);
    }
    return;
  }
  const std::size_t grain = std::max<std::size_t>(1, count / (kRunsPerThread * static_cast<std::size_t>(threads)));
  const auto loop = [&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain),
        [&](const tbb::blocked_range<std::size_t>& run) {
          for (std::size_t i = run.begin(); i < run.end(); ++i) {
            task.check();
            body(i);
          }
        },
        tbb::simple_partitioner());
  };
  // Isolated: a thread that waits for an inner loop must not pick up an item of an outer one, which may hold a lock or
  // fill the same scratch memory.
  if (tbb::this_task_arena::max_concurrency() == threads) {
    tbb::this_task_arena::isolate(loop);
  } else {
    tbb::task_arena(threads).execute([&] { tbb::this_task_arena::isolate(loop); });
  }
}

}  // namespace outcrop

#include "outcrop/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "core/scratch.h"
#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

TEST(ParallelFor, VisitsEveryItemOnceWhateverTheThreads) {
  for (const int threads : {1, 2, 16}) {
    const ThreadLimit limit(threads);
    for (const std::size_t count : {0, 1, 2, 3, 100, 100'003}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_for(count, [&](std::size_t i) { ++visits[i]; });
      for (const auto& n : visits) ASSERT_EQ(n, 1);
    }
  }
}

TEST(ParallelMap, GivesTheSameBytesOnOneThreadAndSixteen) {
  const auto draw = [](std::size_t i) { return Rng(1, "parallel", i).uniform(); };
  const auto on = [&](int threads) {
    const ThreadLimit limit(threads);
    return parallel_map(5000, draw);
  };
  const auto expected = on(1);
  EXPECT_EQ(on(2), expected);
  EXPECT_EQ(on(16), expected);
}

TEST(ParallelFor, UsesNoMoreThreadsThanItsLimitAndMoreThanOne) {
  const ThreadLimit limit(3);
  EXPECT_LE(thread_count(), 3);
  EXPECT_GE(thread_count(), 2);
  std::mutex mutex;
  std::set<std::thread::id> ids;
  parallel_for(300, [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    const std::lock_guard lock(mutex);
    ids.insert(std::this_thread::get_id());
  });
  EXPECT_LE(ids.size(), 3u);
  EXPECT_GE(ids.size(), 2u);
}

TEST(ParallelFor, EvensOutItemsOfUnequalCost) {
  const ThreadLimit limit(2);
  std::mutex mutex;
  std::map<std::thread::id, int> slow_items;
  parallel_for(120, [&](std::size_t i) {
    if (i >= 60) return;  // fixed halves would leave all the slow ones to one thread
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const std::lock_guard lock(mutex);
    ++slow_items[std::this_thread::get_id()];
  });
  ASSERT_EQ(slow_items.size(), 2u);
  for (const auto& [id, count] : slow_items) EXPECT_GE(count, 6);
}

TEST(ParallelFor, RethrowsAndStopsTheRest) {
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    std::atomic<int> started = 0;
    const auto run = [&] {
      parallel_for(100'000, [&](std::size_t i) {
        ++started;
        if (i == 10) throw InputError("item 10");
        std::this_thread::sleep_for(std::chrono::microseconds(10));
      });
    };
    EXPECT_EQ(test::message_of<InputError>(run), "item 10");
    EXPECT_LT(started, 50'000);
  }
}

TEST(ParallelFor, IsCancelledBetweenItems) {
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    std::stop_source source;
    std::atomic<int> started = 0;
    const Task task{.stop = source.get_token()};
    EXPECT_THROW(parallel_for(
                     100'000,
                     [&](std::size_t) {
                       if (++started == 50) source.request_stop();
                     },
                     task),
                 Cancelled);
    EXPECT_LT(started, 10'000);
    EXPECT_THROW(parallel_for(
                     0, [](std::size_t) {}, task),
                 Cancelled);
  }
}

TEST(ParallelFor, NeverRunsAnOuterItemInsideAnInnerLoop) {
  const ThreadLimit limit(4);
  parallel_for(64, [&](std::size_t) {
    static thread_local int depth = 0;
    ++depth;
    ASSERT_EQ(depth, 1);
    parallel_for(64, [](std::size_t) { std::this_thread::sleep_for(std::chrono::microseconds(5)); });
    --depth;
  });
}

TEST(ThreadLimit, HoldsWhileItLives) {
  const int all = thread_count();
  {
    const ThreadLimit one(1);
    EXPECT_EQ(thread_count(), 1);
    std::vector<std::thread::id> ran(1000);
    parallel_for(ran.size(), [&](std::size_t i) { ran[i] = std::this_thread::get_id(); });
    EXPECT_EQ(std::set(ran.begin(), ran.end()), std::set{std::this_thread::get_id()});
  }
  EXPECT_EQ(thread_count(), all);
}

TEST(ThreadLimit, RefusesNegativeCounts) {
  EXPECT_EQ(test::message_of<ParameterError>([] { ThreadLimit limit(-1); }),
            "threads: expected 0 for all cores, or more, got -1");
  const ThreadLimit all(0);
  EXPECT_GE(thread_count(), 1);
}

}  // namespace
}  // namespace outcrop

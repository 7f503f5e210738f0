/// CPU time, for the race: other programs may be busy.
#pragma once

#include <time.h>

namespace outcrop::race {

/// CPU time of the process, all threads, since it was made.
class CpuClock {
 public:
  [[nodiscard]] double seconds() const { return now() - start_; }

 private:
  [[nodiscard]] static double now() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  double start_ = now();
};

}  // namespace outcrop::race

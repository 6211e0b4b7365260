// experiments/benchmarks/contacts/thread_clock.h — processor time of this thread. Where that is limited, Linux
// advances the clock of the process by ticks of some milliseconds only.
#pragma once

#include <ctime>

namespace rival {

inline double thread_time() {  // [s]
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace rival

// experiments/benchmarks/clock.h — what all drivers time with, and Orthant too: the processor time of the process.
#pragma once

#include <ctime>

namespace rival {

inline double processor_time() {  // [s]
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace rival

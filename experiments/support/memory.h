// experiments/support/memory.h — memory of a process, as the kernel counts it (Linux).
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace orthant {

inline double peak_memory() {  // [B] the most so far
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

inline double resident_memory() {  // [B]
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace orthant

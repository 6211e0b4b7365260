// experiments/support/clock.h — processor clock of all benchmark drivers, and of Orthant: the time of the process.
#pragma once

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace rival {

inline double processor_time() {  // [s]
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Timing {
  double seconds = 0;  // a call
  int runs = 0;
};

/// Time of `call`: the median of up to five runs within `most` seconds, after one that fills the caches and counts
/// only if it took that long by itself. A run is as many calls in a row as take 20 µs, for the clock itself takes a
/// part of one; where they are more than one, the clock and `prepare` before each call are timed alone and taken off.
template <class Prepare, class Call> Timing time_calls(Prepare&& prepare, Call&& call, double most = 0.1) {
  constexpr double kLong = 2e-5;  // [s]
  constexpr int kMostCalls = 1 << 14;
  constexpr std::size_t kMostRuns = 5;
  int calls = 1;
  const auto run = [&] {
    double untimed = 0;
    if (calls > 1) {
      untimed = processor_time();
      for (int k = 0; k < calls; ++k) prepare();
      untimed = processor_time() - untimed;
    } else {
      prepare();
    }
    const double begin = processor_time();
    for (int k = 0; k < calls; ++k) {
      if (calls > 1) prepare();
      call();
    }
    return std::max(processor_time() - begin - untimed, 0.0) / calls;
  };
  std::vector<double> times;
  double sum = 0;
  const auto count = [&](double seconds) { times.push_back(seconds), sum += seconds * calls; };
  if (const double first = run(); first >= most)
    count(first);
  else
    while (calls < kMostCalls && run() * calls < kLong) calls *= 2;
  while (times.empty() || (times.size() < kMostRuns && sum + times[0] * calls < most)) count(run());
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return {times[times.size() / 2], static_cast<int>(times.size())};
}

}  // namespace rival

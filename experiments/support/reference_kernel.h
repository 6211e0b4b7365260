// experiments/support/reference_kernel.h — a unit of time that drifts with the machine: times of the same run are given
// as ratios to it.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <ctime>
#include <vector>

namespace orthant {

/// [s] of this thread's processor time.
inline double thread_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One unit: the elimination of a fixed 24 × 24 matrix by plain loops, 4600 multiplications; about 2 µs.
inline double reference_kernel() {
  constexpr int n = 24;
  static double A[n][n];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) A[i][j] = i == j ? n + 1 : 1.0 / (1 + i + j);
  for (int k = 0; k < n; ++k)
    for (int i = k + 1; i < n; ++i) {
      const double f = A[i][k] / A[k][k];
      for (int j = k; j < n; ++j) A[i][j] -= f * A[k][j];
    }
  return A[n - 1][n - 1];
}

/// Units that one call of work() takes: the least of `repeats` times over the least of as many of the kernel's, taken
/// in turn so that both meet the same disturbances.
template <class Work> double units(int repeats, const Work& work) {
  constexpr int kCalls = 30;  // of the kernel a repeat: beyond the clock's resolution
  double least = kInf, unit = kInf;
  volatile double sink = 0;
  for (int k = 0; k < repeats; ++k) {
    const double begin = thread_time();
    for (int call = 0; call < kCalls; ++call) sink = sink + reference_kernel();
    const double middle = thread_time();
    work();
    unit = std::min(unit, (middle - begin) / kCalls), least = std::min(least, thread_time() - middle);
  }
  return least / unit;
}

}  // namespace orthant

// solvers/budget.h — time limit and cancellation, polled once an iteration; free when neither is set.
//
//   A sparse factorization cannot be interrupted: affords() compares its predicted cost (factorization_cost.h) with the
//   remaining time. If that does not suffice, the budget counts as spent.
//   Limits of a fifth of a second and more are kept by the kernel's coarse clock where there is one (Linux: some
//   milliseconds fine): to read it costs a few nanoseconds, where the fine one takes as long as a small problem.
#pragma once

#include <orthant/core/support/factorization_cost.h>

#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>

namespace orthant {

class Budget {
 public:
  /// `seconds` from now on; `cancel` may be null and is only read.
  void start(double seconds, const std::atomic<bool>* cancel) {
    cancel_ = cancel;
    spent_ = false;
    timed_ = seconds < 1e9;  // thirty years are no limit
    coarse_ = seconds >= 0.2;
    if (timed_) end_ = now() + seconds;
  }
  /// True once the time is over or the caller has cancelled.
  bool exhausted() const { return cancelled() || spent_ || (timed_ && now() >= end_); }
  /// True once there is a time limit: only then is a cost worth predicting.
  bool timed() const { return timed_; }
  /// Whether there is time for so many operations; if not, the budget is over.
  bool affords(double operations) const {
    spent_ = spent_ || (timed_ && operations > kOperationsPerSecond * remaining());
    return !spent_;
  }
  double remaining() const {  // [s]; infinity without a limit
    return spent_ ? 0 : timed_ ? std::max(0.0, end_ - now()) : std::numeric_limits<double>::infinity();
  }
  const std::atomic<bool>* cancel() const { return cancel_; }
  bool cancelled() const { return cancel_ != nullptr && cancel_->load(std::memory_order_relaxed); }

 private:
  double now() const {  // [s] since the machine started: nanoseconds are kept for months
#ifdef CLOCK_MONOTONIC_COARSE
    if (timespec t; coarse_ && clock_gettime(CLOCK_MONOTONIC_COARSE, &t) == 0)
      return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
#endif
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
  const std::atomic<bool>* cancel_ = nullptr;
  bool timed_ = false, coarse_ = false;
  mutable bool spent_ = false;
  double end_ = 0;
};

}  // namespace orthant

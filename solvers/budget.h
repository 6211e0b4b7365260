// solvers/budget.h — time limit and cancellation: asked once an iteration, free when neither is set.
#pragma once

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
    timed_ = seconds < 1e9;  // thirty years are no limit, and would overflow the clock
    if (timed_)
      end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  /// True once the time is over or the caller has cancelled.
  bool exhausted() const { return cancelled() || (timed_ && Clock::now() >= end_); }
  double remaining() const {  // [s]; infinity without a limit
    if (!timed_) return std::numeric_limits<double>::infinity();
    return std::max(0.0, std::chrono::duration<double>(end_ - Clock::now()).count());
  }
  const std::atomic<bool>* cancel() const { return cancel_; }
  bool cancelled() const { return cancel_ != nullptr && cancel_->load(std::memory_order_relaxed); }

 private:
  using Clock = std::chrono::steady_clock;
  const std::atomic<bool>* cancel_ = nullptr;
  bool timed_ = false;
  Clock::time_point end_{};
};

}  // namespace orthant

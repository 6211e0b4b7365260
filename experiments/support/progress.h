// experiments/support/progress.h — a progress line: done of total, rate, failures so far, remaining time.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace orthant {

/// One line redrawn on stderr when that is a terminal; else a plain line at each tenth. Safe from several threads.
class Progress {
 public:
  /// `work` is the total in any unit that is proportional to time (steps, say), so that the estimate holds; `count` how
  /// often add() will be called (0: unknown).
  Progress(std::string title, double work, long count = 0);
  ~Progress();
  void add(double work, bool failed);

 private:
  void draw(bool last);
  std::string title_;
  double total_, done_ = 0;
  long count_, added_ = 0;
  int failures_ = 0, drawn_tenths_ = -1;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_, drawn_;
  std::mutex mutex_;
};

}  // namespace orthant

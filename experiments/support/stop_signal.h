// experiments/support/stop_signal.h — Ctrl-C (SIGINT) and SIGTERM as a flag: the work ends soon and keeps what it has.
#pragma once

#include <atomic>
#include <csignal>

namespace orthant {

/// While one lives the first of these signals raises the flag; a second one ends the process, as without it. A signal
/// that is ignored (a shell's background job) stays ignored. One at a time.
class StopSignal {
 public:
  StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;
  ~StopSignal();

  static const std::atomic<bool>* flag();
  /// The signal's number; 0: none came.
  static int which();

 private:
  struct sigaction interrupt_ {
  }, terminate_{};
};

}  // namespace orthant

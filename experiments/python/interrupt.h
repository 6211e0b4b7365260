// experiments/python/interrupt.h — Ctrl-C ends a long solve or run, as it ends Python's own loops.
#pragma once

#include <atomic>
#include <csignal>

namespace orthant::python {

/// While one lives in Python's main thread, SIGINT raises a flag for Solver::set_cancel and Clock::cancel; Python's own
/// handler, which only takes a note, is called as well. Elsewhere, and where SIGINT is not Python's, it does nothing.
/// Three system calls: the cost of a small problem's call stays in microseconds.
class Interruptible {
 public:
  Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  ~Interruptible();

  const std::atomic<bool>* flag() const;

  /// With the interpreter's lock, after the work: raises what Python's handler makes of it, KeyboardInterrupt as a rule.
  void raise() const;

 private:
  bool installed_ = false;
};

}  // namespace orthant::python

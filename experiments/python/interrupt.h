// experiments/python/interrupt.h — Ctrl-C in Python: ends a long solve or run, as it ends Python's own loops.
#pragma once

#include <orthant/solvers/budget.h>

#include <pybind11/pybind11.h>

#include <atomic>
#include <csignal>
#include <functional>
#include <optional>

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

  /// With the interpreter's lock, after the work: the exception that Python's handler raises, as a rule a
  /// KeyboardInterrupt; None without an interruption. For callers that keep their result.
  pybind11::object raised() const;
  /// As raised(), and throws it.
  void raise() const;

 private:
  bool installed_ = false;
};

/// Time limit and Ctrl-C of what is no Solver.
class Watch {
 public:
  explicit Watch(std::optional<double> seconds);
  std::function<bool()> stop() {  // for the work, without the interpreter's lock
    return [this] { return stopped_ = stopped_ || budget_.exhausted(); };
  }
  bool stopped() const { return stopped_; }
  void raise() const { interruptible_.raise(); }

 private:
  Interruptible interruptible_;
  Budget budget_;
  bool stopped_ = false;
};

}  // namespace orthant::python

// experiments/support/isolated.h — process isolation: a crash or an endless loop is an outcome and ends nothing else.
//
//   Each piece of work runs in a fork of this process, so it sees all of its memory, and answers with a text through a
//   pipe. This process must have no other threads. POSIX; on Linux a child dies with its parent.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace orthant {

struct Outcome {
  enum Kind { finished, threw, crashed, killed } kind = finished;
  std::string text;  // what the work returned, the exception's words, or the signal's name
};

class Isolated {
 public:
  /// At most `jobs` ≥ 1 at a time; each may take `memory` bytes of address space (0: no limit), beyond it bad_alloc.
  Isolated(unsigned jobs, std::size_t memory) : jobs_(jobs), memory_(memory) {}
  Isolated(const Isolated&) = delete;
  Isolated& operator=(const Isolated&) = delete;
  ~Isolated();  // kills what still runs

  /// Returns when there is room and `work` has been started; it is killed after `seconds` of wall time. `done` is
  /// called from a later start() or wait().
  void start(std::function<std::string()> work, double seconds, std::function<void(const Outcome&)> done);

  void wait_for_room() { wait_until_at_most(jobs_ - 1); }
  void wait_for_all() { wait_until_at_most(0); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Child {
    int process, pipe;
    Clock::time_point deadline;
    bool killed;
    std::string text;
    std::function<void(const Outcome&)> done;
  };
  void wait_until_at_most(std::size_t running);
  static Outcome reap(const Child& child);

  unsigned jobs_;
  std::size_t memory_;
  std::vector<Child> children_;
};

}  // namespace orthant

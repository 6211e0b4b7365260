#include "experiments/python/interrupt.h"

#include <pybind11/pybind11.h>

#include <unistd.h>

#include <sys/syscall.h>

namespace orthant::python {
namespace {

std::atomic<bool> interrupted = false;  // one flag: only the main thread's call is notified
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch such");
struct sigaction pythons {};

void take_note(int signal) {
  interrupted = true;
  pythons.sa_handler(signal);
}

/// Linux numbers a process's first thread as the process; Python runs handlers in that one. Kept a thread: no system
/// call.
bool is_main_thread() {
  thread_local const bool is_main = syscall(SYS_gettid) == getpid();
  return is_main;
}

}  // namespace

Interruptible::Interruptible() {
  if (!is_main_thread()) return;
  struct sigaction now {};
  now.sa_handler = take_note;
  sigemptyset(&now.sa_mask);
  struct sigaction before {};
  if (sigaction(SIGINT, nullptr, &before) != 0) return;
  // SIG_DFL ends the program by itself, SIG_IGN is somebody's wish; one inside another already has our handler.
  if ((before.sa_flags & SA_SIGINFO) != 0 || before.sa_handler == SIG_DFL || before.sa_handler == SIG_IGN ||
      before.sa_handler == take_note)
    return;
  pythons = before;
  interrupted = false;
  installed_ = sigaction(SIGINT, &now, nullptr) == 0;
}

Interruptible::~Interruptible() {
  if (installed_) sigaction(SIGINT, &pythons, nullptr);
}

const std::atomic<bool>* Interruptible::flag() const { return installed_ ? &interrupted : nullptr; }

void Interruptible::raise() const {
  if (installed_ && interrupted && PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

pybind11::object Interruptible::raised() const {
  try {
    raise();
  } catch (pybind11::error_already_set& error) {
    return error.value();
  }
  return pybind11::none();
}

Watch::Watch(std::optional<double> seconds) {
  budget_.start(seconds.value_or(std::numeric_limits<double>::infinity()), interruptible_.flag());
}

}  // namespace orthant::python

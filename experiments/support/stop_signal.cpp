#include "experiments/support/stop_signal.h"

namespace orthant {
namespace {

std::atomic<bool> stop_raised = false;
std::atomic<int> taken_signal = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free, "for a signal handler");

void take_signal(int signal) {
  taken_signal = signal;
  stop_raised = true;
}

void take_over(int signal, struct sigaction& before) {
  if (sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) return;
  struct sigaction ours {};
  ours.sa_handler = take_signal;
  ours.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;  // the second one is the system's
  sigemptyset(&ours.sa_mask);
  sigaction(signal, &ours, nullptr);
}

}  // namespace

StopSignal::StopSignal() {
  stop_raised = false, taken_signal = 0;
  take_over(SIGINT, interrupt_), take_over(SIGTERM, terminate_);
}

StopSignal::~StopSignal() { sigaction(SIGINT, &interrupt_, nullptr), sigaction(SIGTERM, &terminate_, nullptr); }

const std::atomic<bool>* StopSignal::flag() { return &stop_raised; }
int StopSignal::which() { return taken_signal; }

}  // namespace orthant

#include "experiments/support/status_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace orthant {
namespace {

using LineClock = std::chrono::steady_clock;
constexpr std::chrono::seconds kFirst{2};          // what is shorter needs no line
constexpr std::chrono::milliseconds kRedraw{200};  // slower than an eye follows, cheap on a slow connection

std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80;
}

}  // namespace

StatusLine::StatusLine(std::function<std::string(double)> words) : words_(std::move(words)) {
  if (isatty(STDERR_FILENO) == 1) thread_ = std::thread([this] { show(); });
}

void StatusLine::end() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void StatusLine::show() {
  const auto begin = LineClock::now();
  std::unique_lock lock(mutex_);
  bool drawn = false;
  for (auto next = begin + kFirst; !wake_.wait_until(lock, next, [this] { return over_; });
       next = LineClock::now() + kRedraw) {
    const double seconds = std::chrono::duration<double>(LineClock::now() - begin).count();
    const std::string words = words_(seconds).substr(0, terminal_columns() - 1);
    std::fprintf(stderr, "\r\033[K%s", words.c_str());
    std::fflush(stderr);
    drawn = true;
  }
  if (drawn) std::fputs("\r\033[K", stderr);
}

std::string elapsed_words(const std::string& what, double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, ": %.0f s", seconds);
  return "orthant: " + what + text;
}

}  // namespace orthant

// experiments/support/status_line.h — progress line of a long command on a terminal, redrawn until the work ends.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace orthant {

std::string elapsed_words(const std::string& what, double seconds);

/// Shows words() on standard error from two seconds after the start on, five times a second; erases the line at the
/// end.
/// Only where standard error is a terminal. words(seconds since the start) is called by a thread of its own.
class StatusLine {
 public:
  explicit StatusLine(std::function<std::string(double)> words);
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;
  ~StatusLine() { end(); }

  /// Erases the line; before anything else is written to the terminal.
  void end();

 private:
  void show();
  std::function<std::string(double)> words_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false;
  std::thread thread_;
};

/// Does work() with a line such as "orthant: solve: 12 s", where it is not known how long that takes.
template <class Work> decltype(auto) with_elapsed_line(const std::string& what, Work&& work) {
  const StatusLine line([what](double seconds) { return elapsed_words(what, seconds); });
  return work();
}

}  // namespace orthant

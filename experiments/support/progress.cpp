#include "experiments/support/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace orthant {
namespace {

double since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

Progress::Progress(std::string title, double work, long count)
    : title_(std::move(title)),
      total_(work),
      count_(count),
      terminal_(isatty(STDERR_FILENO) == 1),
      begin_(std::chrono::steady_clock::now()),
      drawn_(begin_) {}

Progress::~Progress() { draw(true); }

void Progress::add(double work, bool failed) {
  const std::lock_guard lock(mutex_);
  done_ += work;
  failures_ += failed;
  ++added_;
  draw(false);
}

void Progress::draw(bool last) {
  const double share = total_ > 0 ? done_ / total_ : 1;
  const double spent = since(begin_), left = share > 0 ? spent * std::max(0.0, 1 - share) / share : 0;
  const char* fail = failures_ == 1 ? "failure" : "failures";
  char cases[64] = "";
  if (count_ > 0)
    std::snprintf(cases, sizeof cases, "%ld/%ld, %.3g/s, ", added_, count_,
                  static_cast<double>(added_) / std::max(spent, 1e-3));
  if (terminal_) {
    if (!last && since(drawn_) < 0.1) return;
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(share * kWidth + 0.5);
    std::fprintf(stderr, "\r%s [%.*s%.*s] %3.0f %%  %s%.0f s left, %d %s   ", title_.c_str(), filled,
                 "##############################", kWidth - filled, "..............................", 100 * share,
                 cases, left, failures_, fail);
    if (last) std::fprintf(stderr, "\r%s: done in %.1f s, %d %s%60s\n", title_.c_str(), spent, failures_, fail, "");
  } else {
    const int tenths = static_cast<int>(share * 10);
    if (!last && tenths == drawn_tenths_) return;
    drawn_tenths_ = tenths;
    if (last)
      std::fprintf(stderr, "%s: done in %.1f s, %d %s\n", title_.c_str(), spent, failures_, fail);
    else
      std::fprintf(stderr, "%s: %.0f %%, %s%.0f s left, %d %s\n", title_.c_str(), 100 * share, cases, left, failures_,
                   fail);
  }
  drawn_ = std::chrono::steady_clock::now();
}

}  // namespace orthant

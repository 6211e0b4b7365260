#include "experiments/support/isolated.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <system_error>

namespace orthant {
namespace {

[[noreturn]] void run(const std::function<std::string()>& work, int pipe, std::size_t memory) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0}, space{memory, memory};
  setrlimit(RLIMIT_CORE, &no_core);
  if (memory > 0) setrlimit(RLIMIT_AS, &space);
  std::string text;
  try {
    text = '.' + work();
  } catch (const std::exception& error) {
    text = std::string("!") + error.what();
  }
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t now = write(pipe, text.data() + sent, text.size() - sent);
    if (now < 0 && errno != EINTR) break;
    if (now > 0) sent += static_cast<std::size_t>(now);
  }
  _exit(0);  // nothing of the parent's is flushed or destroyed here
}

}  // namespace

Isolated::~Isolated() {
  for (const Child& child : children_) {
    kill(child.process, SIGKILL);
    reap(child);
  }
}

Outcome Isolated::reap(const Child& child) {
  close(child.pipe);
  int status = 0;
  while (waitpid(child.process, &status, 0) < 0 && errno == EINTR) {
  }
  if (child.killed) return {Outcome::killed, "out of time"};
  if (WIFSIGNALED(status)) return {Outcome::crashed, strsignal(WTERMSIG(status))};
  if (child.text.empty()) return {Outcome::crashed, "exit code " + std::to_string(WEXITSTATUS(status))};
  return {child.text[0] == '.' ? Outcome::finished : Outcome::threw, child.text.substr(1)};
}

void Isolated::start(std::function<std::string()> work, double seconds, std::function<void(const Outcome&)> done) {
  wait_for_room();
  int ends[2];
  if (pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t process = fork();
  if (process < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (process == 0) {
    close(ends[0]);
    run(work, ends[1], memory_);
  }
  close(ends[1]);
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  children_.push_back({process, ends[0], deadline, false, {}, std::move(done)});
}

void Isolated::wait_until_at_most(std::size_t running) {
  while (children_.size() > running) {
    std::vector<pollfd> pipes;
    auto next = Clock::time_point::max();
    for (const Child& child : children_) {
      pipes.push_back({child.pipe, POLLIN, 0});
      if (!child.killed) next = std::min(next, child.deadline);
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(next - Clock::now()).count();
    const bool all_killed = next == Clock::time_point::max();
    poll(pipes.data(), pipes.size(), all_killed ? -1 : static_cast<int>(std::max<long>(left, 0)));
    for (std::size_t i = children_.size(); i-- > 0;) {
      Child& child = children_[i];
      if (!child.killed && Clock::now() >= child.deadline) {
        kill(child.process, SIGKILL);
        child.killed = true;
      }
      if (pipes[i].revents == 0) continue;
      char buffer[65536];
      const ssize_t got = read(child.pipe, buffer, sizeof buffer);
      if (got < 0) continue;  // interrupted: again
      child.text.append(buffer, static_cast<std::size_t>(got));
      if (got > 0) continue;
      const Outcome outcome = reap(child);
      const auto report = std::move(child.done);
      children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
      report(outcome);
    }
  }
}

}  // namespace orthant

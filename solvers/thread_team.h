// solvers/thread_team.h — thread team: tasks of one loop shared by threads inside a solver.
//
//   run(count, work) calls work(task) once for each task < count and returns when all are done. Which thread takes
//   which task is not fixed, so tasks that run together may write only data of their own: then results have the same
//   bits with any number of threads. A team of one runs the loop itself. A hand-over costs some microseconds.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace orthant {

class ThreadTeam {
 public:
  /// `size` threads, the caller included; ≥ 1.
  explicit ThreadTeam(int size);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  int size() const { return static_cast<int>(threads_.size()) + 1; }

  /// `work` must not throw.
  template <class Work> void run(int count, const Work& work) {
    if (threads_.empty() || count < 2) {
      for (int task = 0; task < count; ++task) work(task);
      return;
    }
    share(
        count, [](const void* context, int task) { (*static_cast<const Work*>(context))(task); }, &work);
  }

 private:
  using Call = void (*)(const void*, int);
  void share(int count, Call call, const void* context);
  void take();
  void serve();

  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable begin_, end_;
  long round_ = 0;  // of share(); −1: the end
  int busy_ = 0;    // threads in the present round
  int count_ = 0;
  std::atomic<int> next_ = 0;
  Call call_ = nullptr;
  const void* context_ = nullptr;
};

}  // namespace orthant

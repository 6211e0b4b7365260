// integrators/solver_pool.h — solver pool: solvers that run in parallel, each in its own thread, for islands.
//
//   Free threads take the tasks 0 … count − 1 one by one. A task writes only its own data, and the answer does not
//   depend on the solver object: results are bit for bit those of one thread. The hand-over of a task costs some
//   microseconds, so a pool pays for islands of a hundred rows, not of ten.
#pragma once

#include <orthant/solvers/solver.h>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace orthant {

class SolverPool {
 public:
  SolverPool() = default;
  explicit SolverPool(std::vector<std::unique_ptr<Solver>> helpers);
  ~SolverPool();
  SolverPool(const SolverPool&) = delete;
  SolverPool& operator=(const SolverPool&) = delete;

  int size() const { return static_cast<int>(helpers_.size()) + 1; }  // with the caller

  /// work(task, solver, worker) once for each task < count, worker in [0, size()): 0 is the caller with `own`. Returns
  /// when all are done; then throws what a task threw, the first of them.
  template <class Work> void run(int count, Solver& own, Work&& work) {
    using Plain = std::remove_reference_t<Work>;
    run(
        count, own,
        [](void* context, int task, Solver& solver, int worker) {
          (*static_cast<Plain*>(context))(task, solver, worker);
        },
        &work);
  }

 private:
  using Call = void (*)(void*, int, Solver&, int);
  void run(int count, Solver& own, Call call, void* context);
  void take(Solver& solver, int worker);  // tasks, until none is left
  void serve(Solver& solver, int worker);

  std::vector<std::unique_ptr<Solver>> helpers_;
  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable begin_, end_;
  long round_ = 0;  // of run(); −1: the end
  int busy_ = 0;    // helpers in the present round
  int count_ = 0, failed_ = 0;
  std::atomic<int> next_ = 0;
  Call call_ = nullptr;
  void* context_ = nullptr;
  std::exception_ptr thrown_;  // by task failed_
};

}  // namespace orthant

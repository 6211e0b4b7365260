#include <orthant/integrators/solver_pool.h>

namespace orthant {

SolverPool::SolverPool(std::vector<std::unique_ptr<Solver>> helpers) : helpers_(std::move(helpers)) {
  threads_.reserve(helpers_.size());
  for (std::size_t i = 0; i < helpers_.size(); ++i)
    threads_.emplace_back([this, i] { serve(*helpers_[i], static_cast<int>(i) + 1); });
}

SolverPool::~SolverPool() {
  {
    const std::lock_guard lock(mutex_);
    round_ = -1;
  }
  begin_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void SolverPool::run(int count, Solver& own, Call call, void* context) {
  {
    const std::lock_guard lock(mutex_);
    for (const auto& helper : helpers_)
      helper->set_cancel(own.cancel()), helper->set_time_limit(own.time_limit()),
          helper->set_outer_budget(own.outer_budget());
    count_ = failed_ = count, call_ = call, context_ = context, thrown_ = nullptr;
    next_ = 0;
    busy_ = static_cast<int>(helpers_.size());
    ++round_;
  }
  begin_.notify_all();
  take(own, 0);
  std::unique_lock lock(mutex_);
  end_.wait(lock, [this] { return busy_ == 0; });
  if (thrown_) std::rethrow_exception(thrown_);
}

void SolverPool::take(Solver& solver, int worker) {
  for (int task = next_++; task < count_; task = next_++) try {
      call_(context_, task, solver, worker);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (task < failed_) failed_ = task, thrown_ = std::current_exception();
    }
}

void SolverPool::serve(Solver& solver, int worker) {
  for (long seen = 0;;) {
    {
      std::unique_lock lock(mutex_);
      begin_.wait(lock, [&] { return round_ != seen; });
      if (round_ < 0) return;
      seen = round_;
    }
    take(solver, worker);
    const std::lock_guard lock(mutex_);
    if (--busy_ == 0) end_.notify_one();
  }
}

}  // namespace orthant

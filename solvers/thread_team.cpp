#include <orthant/solvers/thread_team.h>

namespace orthant {

ThreadTeam::ThreadTeam(int size) {
  for (int i = 1; i < size; ++i) threads_.emplace_back([this] { serve(); });
}

ThreadTeam::~ThreadTeam() {
  {
    const std::lock_guard lock(mutex_);
    round_ = -1;
  }
  begin_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadTeam::share(int count, Call call, const void* context) {
  {
    const std::lock_guard lock(mutex_);
    count_ = count, call_ = call, context_ = context;
    next_ = 0;
    busy_ = static_cast<int>(threads_.size());
    ++round_;
  }
  begin_.notify_all();
  take();
  std::unique_lock lock(mutex_);
  end_.wait(lock, [this] { return busy_ == 0; });
}

void ThreadTeam::take() {
  for (int task = next_++; task < count_; task = next_++) call_(context_, task);
}

void ThreadTeam::serve() {
  for (long seen = 0;;) {
    {
      std::unique_lock lock(mutex_);
      begin_.wait(lock, [&] { return round_ != seen; });
      if (round_ < 0) return;
      seen = round_;
    }
    take();
    const std::lock_guard lock(mutex_);
    if (--busy_ == 0) end_.notify_one();
  }
}

}  // namespace orthant

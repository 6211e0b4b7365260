// experiments/support/parallel.h — independent cases over all cores; results land by index, so order never matters.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace orthant {

/// Calls work(i) for 0 ≤ i < count on `jobs` threads (0: one a core). The first exception is thrown again here.
template <class Work> void parallel_for(std::size_t count, unsigned jobs, Work&& work) {
  if (jobs == 0) jobs = std::max(1U, std::thread::hardware_concurrency());
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex mutex;
  {
    std::vector<std::jthread> threads;
    for (unsigned j = 0; j < jobs; ++j)
      threads.emplace_back([&] {
        try {
          for (std::size_t i = next++; i < count; i = next++) work(i);
        } catch (...) {
          const std::lock_guard lock(mutex);
          if (!error) error = std::current_exception();
          next = count;
        }
      });
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace orthant

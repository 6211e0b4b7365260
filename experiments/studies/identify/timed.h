// experiments/studies/identify/timed.h — wall time of a search, and its error message.
#pragma once

#include <chrono>
#include <exception>
#include <string>

namespace orthant {

struct Timed {
  double seconds = 0;
  std::string failure;  // empty: none
};

template <class F> Timed time_of(F&& run) {
  Timed timed;
  const auto begin = std::chrono::steady_clock::now();
  try {
    run();
  } catch (const std::exception& error) {
    timed.failure = error.what();
  }
  timed.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return timed;
}

}  // namespace orthant

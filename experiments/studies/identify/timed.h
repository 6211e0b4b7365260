// experiments/studies/identify/timed.h — processor time of a search, and its error message.
#pragma once

#include "experiments/support/clock.h"

#include <exception>
#include <string>

namespace orthant {

struct Timed {
  double seconds = 0;
  std::string failure;  // empty: none
};

template <class F> Timed time_of(F&& run) {
  Timed timed;
  const double begin = rival::processor_time();
  try {
    run();
  } catch (const std::exception& error) {
    timed.failure = error.what();
  }
  timed.seconds = rival::processor_time() - begin;
  return timed;
}

}  // namespace orthant

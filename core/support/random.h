// core/support/random.h — random numbers that are the same on every machine.
#pragma once

#include <cstdint>
#include <random>

namespace orthant {

/// The same numbers on every machine and with every compiler: std::mt19937_64, which the standard fixes bit by bit, and
/// mappings of our own, which std::*_distribution are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // [0, 1)
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  int integer(int lo, int hi) {  // lo … hi
    return lo + static_cast<int>(engine_() % static_cast<std::uint64_t>(hi - lo + 1));
  }
  double normal() {  // sum of 12 uniform numbers: no logarithm whose last bit differs between libraries
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace orthant

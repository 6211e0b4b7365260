// tests/support/scene_draws.h — random numbers of test scenes, the same on every system.
#pragma once

#include <cmath>
#include <random>

namespace orthant {

class SceneDraws {
 public:
  explicit SceneDraws(unsigned seed) : bits_(seed) {}
  /// With three decimals, which a scene's text holds.
  double between(double low, double high) {
    const double x = low + (high - low) * static_cast<double>(bits_()) / 4294967296.0;
    return std::round(1000 * x) / 1000;
  }
  bool one_in(unsigned n) { return bits_() % n == 0; }
  double zero_or(double low, double high) { return one_in(2) ? 0 : between(low, high); }

 private:
  std::mt19937 bits_;
};

}  // namespace orthant

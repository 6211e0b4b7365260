#include <orthant/core/scenes/collinear.h>

#include <cstddef>

namespace orthant {

std::vector<double> strike_in_turn(const std::vector<double>& masses, std::vector<double> speeds, double e) {
  constexpr double kEnough = 1e-16;
  double first = 0;
  for (;;) {
    std::size_t pair = 0;
    double fastest = kEnough * first;
    for (std::size_t i = 0; i + 1 < speeds.size(); ++i)
      if (const double approach = speeds[i] - speeds[i + 1]; approach > fastest) fastest = approach, pair = i + 1;
    if (pair == 0) return speeds;
    if (first == 0) first = fastest;
    const double impulse = (1 + e) * fastest / (1 / masses[pair - 1] + 1 / masses[pair]);
    speeds[pair - 1] -= impulse / masses[pair - 1], speeds[pair] += impulse / masses[pair];
  }
}

}  // namespace orthant

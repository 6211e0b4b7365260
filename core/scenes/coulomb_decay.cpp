#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/oscillator.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant {

double CoulombDecay::half_swing() const { return std::numbers::pi * std::sqrt(mass / stiffness); }

int CoulombDecay::half_swings() const {
  const double centre = mu * mass * g / stiffness;
  return std::max(0, static_cast<int>(std::ceil((std::abs(start) - centre) / (2 * centre))));
}

Motion CoulombDecay::at(double t) const {
  const double centre = mu * mass * g / stiffness, w = std::numbers::pi / half_swing();
  const int n = static_cast<int>(std::min(std::floor(t / half_swing()), centre > 0 ? half_swings() : 1e9));
  const double sign = (start < 0 ? -1 : 1) * (n % 2 == 0 ? 1 : -1);  // of the turning point
  const double turn = std::abs(start) - 2 * n * centre;
  if (turn <= centre) return {sign * turn, 0};
  const double angle = w * t - n * std::numbers::pi;
  return {sign * (centre + (turn - centre) * std::cos(angle)), -sign * (turn - centre) * w * std::sin(angle)};
}

Scene coulomb_decay(const CoulombDecay& p) {
  Scene s = oscillator(p.mass, p.stiffness, {p.start, 0});
  s.gravity = {0, -p.g};
  s.duration = 10 * p.half_swing(), s.step = 1e-3;
  s.contact(CornerWall{"floor", 0, {0, 0}, kGround, {0, 0}, {0, 1}, {.mu = p.mu}});
  return s;
}

}  // namespace orthant

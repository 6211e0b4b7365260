#include <orthant/core/scenes/oscillator.h>
#include <orthant/core/scenes/stick_slip.h>

#include <cmath>
#include <numbers>

namespace orthant {

double StickSlip::frequency() const { return std::sqrt(stiffness / mass); }
double StickSlip::stick_time() const { return 2 * (static_stretch() - kinetic_stretch()) / belt; }
double StickSlip::slip_time() const {
  const double swing = (static_stretch() - kinetic_stretch()) * frequency();
  return 2 * (std::numbers::pi - std::atan(swing / belt)) / frequency();
}

Motion StickSlip::at(double t) const {
  const double tau = std::fmod(t, period()), swing = static_stretch() - kinetic_stretch();
  if (tau < stick_time()) return {kinetic_stretch() - swing + belt * tau, belt};
  const double w = frequency(), angle = w * (tau - stick_time());
  return {kinetic_stretch() + swing * std::cos(angle) + belt / w * std::sin(angle),
          -swing * w * std::sin(angle) + belt * std::cos(angle)};
}

Scene stick_slip(const StickSlip& p) {
  Scene s = oscillator(p.mass, p.stiffness, p.at(0));
  s.gravity = {0, -p.g};
  s.duration = 2 * p.period(), s.step = 1e-3;
  s.contact(
      CornerWall{"belt", 0, {0, 0}, kGround, {0, 0}, {0, 1}, {.mu = p.mu, .mu_static = p.mu_static, .belt = p.belt}});
  return s;
}

}  // namespace orthant

#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/oscillator.h>

#include <cmath>
#include <numbers>

namespace orthant {

double ImpactOscillator::period() const { return 2 * std::numbers::pi / omega; }

double ImpactOscillator::phase() const {
  const double tangent = std::tan(period() / 2), amplitude = 1 / (1 - omega * omega);
  const double phi = std::atan(-(1 - e) / ((1 + e) * omega) * tangent);
  const double speed = amplitude * (std::cos(phi) * tangent - omega * std::sin(phi));
  return speed > 0 ? phi : phi + (phi > 0 ? -1 : 1) * std::numbers::pi;
}

double ImpactOscillator::impact_speed() const {
  return (std::cos(phase()) * std::tan(period() / 2) - omega * std::sin(phase())) / (1 - omega * omega);
}

Motion ImpactOscillator::at(double t) const {
  const double tau = std::fmod(t, period()), phi = phase(), amplitude = 1 / (1 - omega * omega);
  const double a = -amplitude * std::cos(phi), b = a * std::tan(period() / 2);
  return {a * std::cos(tau) + b * std::sin(tau) + amplitude * std::cos(omega * tau + phi),
          -a * std::sin(tau) + b * std::cos(tau) - amplitude * omega * std::sin(omega * tau + phi)};
}

Scene impact_oscillator(const ImpactOscillator& p) {
  Scene s = oscillator(1, 1, {0, -p.e * p.impact_speed() + p.disturbance});
  s.duration = 10 * p.period(), s.step = 1e-3;
  s.contact(CornerWall{"wall", 0, {0, 0}, kGround, {0, 0}, {-1, 0}, {.e = p.e}});
  s.load({.name = "drive",
          .body = 0,
          .force = {1, 0},
          .factor = [omega = p.omega, phi = p.phase()](double t) { return std::cos(omega * t + phi); },
          .omega = p.omega});
  return s;
}

}  // namespace orthant

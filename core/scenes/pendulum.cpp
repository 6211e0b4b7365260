#include <orthant/core/scenes/elliptic.h>
#include <orthant/core/scenes/pendulum.h>

#include <cmath>
#include <numbers>

namespace orthant {

double Pendulum::period() const { return 2 * std::numbers::pi / (std::sqrt(g / length) * agm(1, std::cos(angle / 2))); }

Motion Pendulum::at(double t) const {
  const double w = std::sqrt(g / length), k = std::sin(angle / 2), k_prime = std::cos(angle / 2);
  const double phi = amplitude(quarter_period(k_prime) + w * t, k_prime);
  return {2 * std::asin(k * std::sin(phi)), 2 * k * w * std::cos(phi)};  // d/dt: cn dn / √(1 − k² sn²) = cn
}

Scene pendulum(const Pendulum& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 2 * p.period(), s.step = 1e-3;
  const Vector2d position = p.length * Vector2d(std::sin(p.angle), -std::cos(p.angle));
  const auto bob = s.body({.name = "bob", .mass = p.mass, .inertia = p.mass, .position = position});
  s.joint(Distance{"rod", bob, kGround, {0, 0}, {0, 0}, p.length});
  return s;
}

}  // namespace orthant

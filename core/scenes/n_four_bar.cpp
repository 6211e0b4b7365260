#include <orthant/core/scenes/elliptic.h>
#include <orthant/core/scenes/n_four_bar.h>

#include <cmath>
#include <numbers>

namespace orthant {
namespace {

double inertia(int loops) { return (loops + 1) / 3.0 + loops; }  // [kg m²] about the pivots
double weight_arm(int loops) { return (loops + 1) / 2.0 + loops; }

}  // namespace

double NFourBar::stiffness() const { return g * weight_arm(loops) / inertia(loops); }
double NFourBar::turn_time() const {
  return 2 * std::numbers::pi / agm(speed, std::hypot(speed, 2 * std::sqrt(stiffness())));
}
double NFourBar::energy() const { return inertia(loops) * speed * speed / 2 + g * weight_arm(loops); }

Motion NFourBar::at(double t) const {
  const double b = std::hypot(speed, 2 * std::sqrt(stiffness())), k_prime = speed / b;
  const double psi = amplitude(b / 2 * t - quarter_period(k_prime), k_prime);
  return {std::numbers::pi + 2 * psi, std::hypot(b * std::cos(psi), speed * std::sin(psi))};
}

Scene n_four_bar(const NFourBar& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 10, s.step = 1e-3;
  const double rod = 1.0 / 12;  // [kg m²]
  for (int i = 0; i <= p.loops; ++i) {
    const auto crank = s.body({.inertia = rod, .position = {i, 0.5}, .velocity = {p.speed / 2, 0}, .omega = -p.speed});
    s.joint(Revolute{"", kGround, crank, {i, 0}, {0, -0.5}});
  }
  for (int i = 0; i < p.loops; ++i) {
    const auto coupler = s.body({.inertia = rod, .position = {i + 0.5, 1}, .velocity = {p.speed, 0}});
    s.joint(Revolute{"", i, coupler, {0, 0.5}, {-0.5, 0}});
    s.joint(Revolute{"", i + 1, coupler, {0, 0.5}, {0.5, 0}});
  }
  return s;
}

}  // namespace orthant

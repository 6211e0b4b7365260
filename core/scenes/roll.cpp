#include <orthant/core/scenes/roll.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {

double Roll::rolling_time() const {
  const double k = inertia_factor, brake = g * (mu * std::cos(slope) * (1 + 1 / k) - std::sin(slope));
  return brake > 0 || (brake == 0 && speed == 0) ? (speed > 0 ? speed / brake : 0)
                                                 : std::numeric_limits<double>::infinity();
}

Motion Roll::at(double t) const {
  const double slide = std::min(t, rolling_time()), rest = t - slide;
  const double sliding = g * (std::sin(slope) - mu * std::cos(slope)),
               rolling = g * std::sin(slope) / (1 + inertia_factor);
  const double v = speed + sliding * slide;
  return {(speed + sliding / 2 * slide) * slide + (v + rolling / 2 * rest) * rest, v + rolling * rest};
}

double Roll::omega(double t) const {
  return -(t >= rolling_time() ? at(t).v : mu * g * std::cos(slope) / inertia_factor * t) / radius;
}

Scene roll(const Roll& p) {
  Scene s;
  s.gravity = {p.g * std::sin(p.slope), -p.g * std::cos(p.slope)};
  s.duration = 1.5, s.step = 1e-3;
  const auto ball = s.body({.name = "ball",
                            .inertia = p.inertia_factor * p.radius * p.radius,
                            .position = {0, p.radius},
                            .velocity = {p.speed, 0}});
  s.contact(DiscWall{"slope", ball, {0, 0}, p.radius, kGround, {0, 0}, {0, 1}, {.mu = p.mu}});
  return s;
}

}  // namespace orthant

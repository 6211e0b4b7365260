#include <orthant/core/scenes/bouncing_ball.h>

#include <cmath>
#include <limits>

namespace orthant {

double BouncingBall::impact_time(int n) const {
  const double flights = e < 1 ? (1 - std::pow(e, n - 1)) / (1 - e) : n - 1;
  return std::sqrt(2 * height / g) * (1 + 2 * e * flights);
}

double BouncingBall::zeno_time() const {
  return e < 1 ? std::sqrt(2 * height / g) * (1 + e) / (1 - e) : std::numeric_limits<double>::infinity();
}

int BouncingBall::impacts(double t) const {
  constexpr double kRounding = 1e-17;  // flights shorter than this part of the first do not show in tₙ
  int n = 0;
  for (; impact_time(n + 1) <= t; ++n)
    if (std::pow(e, n) < kRounding) return std::numeric_limits<int>::max();
  return t >= zeno_time() ? std::numeric_limits<int>::max() : n;
}

Motion BouncingBall::at(double t) const {
  const int n = impacts(t);
  if (n == std::numeric_limits<int>::max()) return {0, 0};
  if (n == 0) return {height - g / 2 * t * t, -g * t};
  const double flight = t - impact_time(n), speed = std::sqrt(2 * g * height) * std::pow(e, n);
  return {(speed - g / 2 * flight) * flight, speed - g * flight};
}

Scene bouncing_ball(const BouncingBall& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 2, s.step = 1e-3;
  const auto ball = s.body({.name = "ball", .mass = p.mass, .inertia = p.mass, .position = {0, p.height}});
  s.contact(CornerWall{"floor", ball, {0, 0}, kGround, {0, 0}, {0, 1}, {.e = p.e}});
  return s;
}

}  // namespace orthant

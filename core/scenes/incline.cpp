#include <orthant/core/scenes/incline.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

/// Acceleration up the slope of a block that slides in the direction `sign`.
double sliding(const Incline& p, double sign) { return -p.g * (std::sin(p.slope) + sign * p.mu * std::cos(p.slope)); }

double sign_of(double speed) { return speed < 0 ? -1 : 1; }

}  // namespace

double Incline::stop_time() const {
  const double a = sliding(*this, sign_of(speed));
  return a * speed < 0 ? -speed / a : speed == 0 ? 0 : std::numeric_limits<double>::infinity();
}

Motion Incline::at(double t) const {
  const double stop = std::min(t, stop_time()), rest = t - stop;
  const double before = sliding(*this, sign_of(speed));
  const double after = std::max(mu, mu_static) >= std::tan(slope) ? 0 : sliding(*this, -1);
  return {(speed + before / 2 * stop) * stop + after / 2 * rest * rest,
          rest > 0 ? after * rest : speed + before * stop};
}

Scene incline(const Incline& p) {
  Scene s;
  s.gravity = {-p.g * std::sin(p.slope), -p.g * std::cos(p.slope)};
  s.duration = 2, s.step = 1e-3;
  const auto block = s.body({.name = "block", .velocity = {p.speed, 0}});
  s.contact(CornerWall{"slope", block, {0, 0}, kGround, {0, 0}, {0, 1}, {.mu = p.mu, .mu_static = p.mu_static}});
  return s;
}

}  // namespace orthant

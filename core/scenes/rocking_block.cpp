#include <orthant/core/scenes/elliptic.h>
#include <orthant/core/scenes/rocking_block.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace orthant {

double RockingBlock::slenderness() const { return std::atan2(half_width, half_height); }
double RockingBlock::ratio() const {
  const double s = std::sin(slenderness());
  return std::max(0.0, 1 - 1.5 * s * s);
}
double RockingBlock::rate() const { return std::sqrt(0.75 * g / std::hypot(half_width, half_height)); }

double RockingBlock::turning(int n) const {
  const double alpha = slenderness(), c = std::cos(alpha);
  return std::acos(c + std::pow(ratio(), 2 * n) * (std::cos((1 - tilt) * alpha) - c));
}

double RockingBlock::fall(int n) const {  // as a pendulum that swings through π − φ: modulus cos(φₙ / 2)
  const double phi = turning(n), k = std::cos(phi / 2), k_prime = std::sin(phi / 2);
  const double low = std::asin(std::min(1.0, std::cos(slenderness() / 2) / k));
  return (quarter_period(k_prime) - elliptic_integral(low, k_prime)) / rate();
}

double RockingBlock::impact_time(int n) const {
  if (n > 1 && ratio() == 0) return std::numeric_limits<double>::infinity();
  double t = fall(0);
  for (int i = 1; i < n; ++i) t += 2 * fall(i);
  return t;
}

double RockingBlock::impact_speed(int n) const {
  return rate() * std::sqrt(2 * (std::cos(turning(n - 1)) - std::cos(slenderness())));
}

Motion RockingBlock::at(double t) const {
  constexpr double kNone = 1e-12;  // of t: arcs that short are the last ones, it stands
  double turn = 0;                 // [s] the turning point of this arc
  int n = 0;
  for (double end = fall(0), half; t > end; turn = end + half, end = turn + half)
    if (half = fall(++n); !(half > kNone * t) || ratio() == 0) return {0, 0};
  const double k_prime = std::sin(turning(n) / 2), k = std::cos(turning(n) / 2), after = t - turn;
  const double x = 2 * std::asin(k * std::sin(amplitude(quarter_period(k_prime) - rate() * std::abs(after), k_prime)));
  const double theta = slenderness() - (std::numbers::pi - x), side = n % 2 == 0 ? 1 : -1;
  const double speed = rate() * std::sqrt(std::max(0.0, 2 * (std::cos(turning(n)) + std::cos(x))));
  return {side * theta, after < 0 ? side * speed : -side * speed};
}

Scene rocking_block(const RockingBlock& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 2, s.step = 1e-3;
  const double b = p.half_width, h = p.half_height, theta = p.tilt * p.slenderness();
  const double c = std::cos(theta), t = std::sin(theta);
  const auto block = s.body({.name = "block",
                             .inertia = (b * b + h * h) / 3,
                             .position = {-b + c * b - t * h, t * b + c * h},
                             .angle = theta});
  s.contact(CornerWall{"left", block, {-b, -h}, kGround, {0, 0}, {0, 1}, {.mu = p.mu}});
  s.contact(CornerWall{"right", block, {b, -h}, kGround, {0, 0}, {0, 1}, {.mu = p.mu}});
  return s;
}

}  // namespace orthant

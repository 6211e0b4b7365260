#include <orthant/core/scenes/sphere_bounce.h>

#include <algorithm>
#include <cmath>

namespace orthant {

SphereBounce::Velocities SphereBounce::after() const {
  const double k = inertia_factor, most = mu * (1 + e) * vy;
  const double impulse = std::clamp(-vx * k / (1 + k), -most, most);  // per mass, along x, at the lowest point
  return {vx + impulse, e * vy, impulse / k};
}

Scene sphere_bounce(const SphereBounce& p) {
  Scene s;
  s.duration = 0.5 / p.vy, s.step = 0x1p-10 / p.vy;
  s.restitution = p.restitution;
  const auto ball =
      s.body({.name = "ball", .inertia = p.inertia_factor, .position = {0, 1.125}, .velocity = {p.vx, -p.vy}});
  s.contact(DiscWall{"floor", ball, {0, 0}, 1, kGround, {0, 0}, {0, 1}, {.mu = p.mu, .e = p.e}});
  return s;
}

}  // namespace orthant

#include <orthant/core/scenes/rod_drop.h>

#include <cmath>

namespace orthant {

RodDrop::Answer RodDrop::after() const {
  const double c = std::cos(angle), impulse = (1 + e) * speed / (1 + 3 * c * c);
  return {impulse, impulse - speed, -3 * impulse * c};
}

Scene rod_drop(const RodDrop& p) {
  Scene s;
  s.duration = 0.02 / p.speed, s.step = 1e-3 / p.speed;
  s.restitution = p.restitution;
  const auto rod = s.body({.name = "rod",
                           .inertia = 1.0 / 3,
                           .position = {0, std::sin(p.angle) + 0.01},
                           .angle = p.angle,
                           .velocity = {0, -p.speed}});
  s.contact(CornerWall{"left", rod, {-1, 0}, kGround, {0, 0}, {0, 1}, {.e = p.e}});
  s.contact(CornerWall{"right", rod, {1, 0}, kGround, {0, 0}, {0, 1}, {.e = p.e}});
  return s;
}

}  // namespace orthant

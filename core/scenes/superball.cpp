#include <orthant/core/scenes/collinear.h>
#include <orthant/core/scenes/superball.h>

#include <limits>

namespace orthant {

SuperBall::Speeds SuperBall::after() const {
  if (gap == 0 && impacts == Impacts::simultaneous) return {e * speed, e * speed};
  const auto u =
      strike_in_turn({1, ratio, std::numeric_limits<double>::infinity()}, {speed, speed, 0}, e);  // downwards
  return {-u[1], -u[0]};
}

Scene superball(const SuperBall& p) {
  constexpr double radius = 0.125;
  Scene s;
  s.duration = 1 / p.speed, s.step = 0x1p-10 / p.speed;
  s.impacts = p.impacts, s.restitution = p.restitution;
  const auto ball = [&](const char* name, double mass, double y) {
    return s.body({.name = name,
                   .mass = mass,
                   .inertia = 0.4 * mass * radius * radius,
                   .position = {0, y},
                   .velocity = {0, -p.speed}});
  };
  const auto lower = ball("lower", p.ratio, 2 * radius), upper = ball("upper", 1, 4 * radius + p.gap);
  s.contact(DiscWall{"floor", lower, {0, 0}, radius, kGround, {0, 0}, {0, 1}, {.e = p.e}});
  s.contact(DiscDisc{"balls", upper, {0, 0}, radius, lower, {0, 0}, radius, {.e = p.e}});
  return s;
}

}  // namespace orthant

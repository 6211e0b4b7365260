#include <orthant/core/scenes/collinear.h>
#include <orthant/core/scenes/cradle.h>

namespace orthant {

std::vector<double> Cradle::after() const {
  const auto n = static_cast<std::size_t>(balls);
  if (gap == 0 && impacts == Impacts::simultaneous) {
    std::vector<double> u(n, speed * (1 + e) / balls);
    u.front() = speed * (1 - (balls - 1) * e) / balls;
    return u;
  }
  std::vector<double> u(n, 0.0);
  u.front() = speed;
  return strike_in_turn(std::vector<double>(n, 1.0), u, e);
}

Scene cradle(const Cradle& p) {
  constexpr double radius = 0.5;
  Scene s;
  s.duration = (0.5 + p.balls * p.gap) / p.speed, s.step = 0x1p-10 / p.speed;
  s.impacts = p.impacts, s.restitution = p.restitution;
  for (int i = 0; i < p.balls; ++i)
    s.body({.inertia = 0.1,
            .position = {i == 0 ? -0.125 : i + (i - 1) * p.gap, 0},
            .velocity = {i == 0 ? p.speed : 0, 0}});
  for (int i = 0; i + 1 < p.balls; ++i) s.contact(DiscDisc{"", i + 1, {0, 0}, radius, i, {0, 0}, radius, {.e = p.e}});
  return s;
}

}  // namespace orthant

#include <orthant/core/scenes/table.h>

#include <algorithm>
#include <cmath>

namespace orthant {

double Table::misfit(std::span<const double> forces) const {
  double sum = -weight(), moment = -weight() * offset, worst = 0;
  for (int i = 0; i < legs; ++i) {
    const double force = forces[static_cast<std::size_t>(i)];
    sum += force, moment += force * leg(i);
    worst = std::max(worst, -force);
  }
  return std::max({worst, std::abs(sum), std::abs(moment)});
}

Scene table(const Table& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 0.125, s.step = 0x1p-7;
  const auto top = s.body({.name = "top", .inertia = 0.5, .position = {p.offset, 0.5}});
  for (int i = 0; i < p.legs; ++i)
    s.contact(CornerWall{"", top, {p.leg(i) - p.offset, -0.5}, kGround, {0, 0}, {0, 1}, {}});
  return s;
}

}  // namespace orthant

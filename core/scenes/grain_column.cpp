#include <orthant/core/scenes/grain_column.h>

namespace orthant {

Scene grain_column(const GrainColumn& p) {
  constexpr double radius = 0.5;
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 0.125, s.step = 0x1p-7;
  for (int i = 0; i < p.grains; ++i) s.body({.inertia = 0.1, .position = {0, i + radius}, .velocity = {0, -p.speed}});
  s.contact(DiscWall{.name = "floor", .a = 0, .radius = radius});
  for (int i = 1; i < p.grains; ++i) s.contact(DiscDisc{.a = i, .radius_a = radius, .b = i - 1, .radius_b = radius});
  return s;
}

}  // namespace orthant

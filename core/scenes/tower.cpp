#include <orthant/core/scenes/tower.h>

#include <cmath>

namespace orthant {

double Tower::mass(int block) const { return std::pow(ratio, block - 1); }

double Tower::force(int level) const {
  double sum = 0;
  for (int block = level; block <= blocks; ++block) sum += mass(block) * g;
  return sum;
}

Scene tower(const Tower& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 0.125, s.step = 0x1p-7;
  for (int i = 0; i < p.blocks; ++i) {
    const double m = p.mass(i + 1);
    const auto block = s.body({.mass = m, .inertia = m / 6, .position = {0, i + 0.5}});
    const Vector2d wall = i == 0 ? Vector2d(0, 0) : Vector2d(0, 0.5);  // the ground's, or the top of the block below
    for (int c = 0; c < p.corners; ++c)
      s.contact(
          CornerWall{"", block, {p.corners == 1 ? 0 : c - 0.5, -0.5}, i == 0 ? kGround : block - 1, wall, {0, 1}, {}});
  }
  return s;
}

}  // namespace orthant

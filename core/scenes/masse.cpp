#include <orthant/core/scenes/masse.h>

namespace orthant {

spatial::Scene masse(const Masse& p) {
  spatial::Scene s;
  s.gravity = {0, 0, -p.g};
  s.duration = 1, s.step = 1e-3;
  const auto ball = s.body({.name = "ball",
                            .mass = p.mass,
                            .inertia = Vector3d::Constant(0.4 * p.mass * p.radius * p.radius).asDiagonal(),
                            .position = {0, 0, p.radius},
                            .velocity = {p.vx, p.vy, 0},
                            .omega = {p.wx, p.wy, p.wz}});
  s.contact(spatial::SpherePlane{"table", ball, {0, 0, 0}, p.radius, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = p.mu}});
  return s;
}

}  // namespace orthant

#include <orthant/core/scenes/euler_disc.h>

#include <cmath>
#include <numbers>

namespace orthant {

spatial::Scene euler_disc(const EulerDisc& p) {
  const double tilt = p.tilt * std::numbers::pi / 180, R2 = p.radius * p.radius;
  const Vector3d up_the_disc(std::cos(tilt), 0, std::sin(tilt));  // the diameter through the contact
  const double Omega = std::sqrt(4 * p.g / (p.radius * std::sin(tilt)));
  spatial::Scene s;
  s.gravity = {0, 0, -p.g};
  s.step = 1e-5;
  const auto disc = s.body({.name = "disc",
                            .mass = p.mass,
                            .inertia = p.mass * Vector3d(R2 / 4, R2 / 4, R2 / 2).asDiagonal(),
                            .position = {0, 0, p.radius * std::sin(tilt)},
                            .orientation = quaternions::exponential(Vector3d(0, -tilt, 0)).normalized(),
                            .omega = -Omega * std::sin(tilt) * up_the_disc});
  s.contact(spatial::RimPlane{.name = "edge", .a = disc, .radius = p.radius, .law = {.mu = p.mu}});
  return s;
}

}  // namespace orthant

#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/spherical_chain.h>

#include <cmath>
#include <numbers>
#include <string>

namespace orthant {

spatial::Scene spherical_chain(const SphericalChain& p) {
  spatial::Scene s;
  s.gravity = {0, 0, -p.g};
  s.duration = 1, s.step = 1e-3;
  const Eigen::Vector4d along_x(std::sqrt(0.5), 0, std::sqrt(0.5), 0);  // turns z to x
  const Vector3d start(0, 0, -0.5), end(0, 0, 0.5);
  BodyId before = kGround;
  for (int i = 0; i < p.links; ++i) {
    const BodyId rod = s.body({.name = "rod" + std::to_string(i + 1),
                               .mass = 1,
                               .inertia = spatial::cylinder(p.radius, 1).inertia,
                               .position = {i + 0.5, 0, 0},
                               .orientation = along_x});
    s.joint(spatial::Spherical{"joint" + std::to_string(i + 1), before, rod,
                               before == kGround ? Vector3d(0, 0, 0) : end, start});
    before = rod;
  }
  // The push turns the last rod about its upper end.
  spatial::Body& last = s.bodies.back();
  last.velocity = {0, p.push / 2, 0}, last.omega = {0, 0, p.push};
  return s;
}

}  // namespace orthant

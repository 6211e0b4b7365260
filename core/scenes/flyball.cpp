#include <orthant/core/scenes/flyball.h>

#include <cmath>
#include <numbers>

namespace orthant {

spatial::Scene flyball(const Flyball& p) {
  const double rod = 0.3, ball = 5, side = 0.01;                         // [kg, kg, m]
  const double mass = rod + ball, from_hinge = (rod / 2 + ball) / mass;  // [kg], [m] of the centre of mass
  const double own = rod * (1 + side * side) / 12, spin = rod * 2 * side * side / 12;
  const double across = own + rod * std::pow(from_hinge - 0.5, 2) + ball * std::pow(1 - from_hinge, 2);
  const Vector3d omega(0, 0, 2 * std::numbers::pi);
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  s.duration = 10, s.step = 1e-3;
  const auto shaft = s.body({.name = "shaft",
                             .mass = rod,
                             .inertia = Vector3d(own, own, spin).asDiagonal(),
                             .position = {0, 0, 0.5},
                             .omega = omega});
  const auto slider = s.body({.name = "slider",
                              .mass = 3,
                              .inertia = Vector3d::Constant(3 * 0.02 / 12).asDiagonal(),
                              .position = {0, 0, 0.5},
                              .omega = omega});
  s.joint(spatial::Revolute{"bearing", kGround, shaft, {0, 0, 0}, {0, 0, -0.5}});
  s.joint(spatial::Prismatic{"sleeve", shaft, slider, {0, 0, -0.5}, {0, 0, 0}, {0, 0, 1}});
  for (const double x : {-1, 1}) {
    // The rod's x axis points outwards and down.
    const double down = std::numbers::pi / 6;
    const Eigen::Quaterniond q =
        Eigen::AngleAxisd(x > 0 ? 0 : std::numbers::pi, Vector3d::UnitZ()) * Eigen::AngleAxisd(down, Vector3d::UnitY());
    const Vector3d hinge(0.05 * x, 0, 1), centre = hinge + q * Vector3d(from_hinge, 0, 0);
    const std::string which = x > 0 ? "right" : "left";
    const auto arm = s.body({.name = "arm_" + which,
                             .mass = mass,
                             .inertia = Vector3d(spin, across, across).asDiagonal(),
                             .position = centre,
                             .orientation = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).normalized(),
                             .velocity = omega.cross(centre),
                             .omega = omega});
    // The angle is that of the rod below the horizontal.
    s.joint(spatial::Revolute{"hinge_" + which,
                              shaft,
                              arm,
                              {0.05 * x, 0, 0.5},
                              {-from_hinge, 0, 0},
                              {0, x, 0},
                              {0, 1, 0},
                              {x, 0, 0},
                              {1, 0, 0}});
    s.spring(spatial::PointSpring{
        "spring_" + which, slider, arm, {0.05 * x, 0, 0}, {0.5 - from_hinge, 0, 0}, p.stiffness, p.damping, 0.5});
  }
  return s;
}

}  // namespace orthant

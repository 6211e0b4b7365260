#include <orthant/core/scenes/top.h>

#include <numbers>

namespace orthant {

spatial::Scene top(const Top& p) {
  const double tilt = p.tilt * std::numbers::pi / 180, across = p.I1 - p.mass * p.l * p.l;
  const Eigen::Quaterniond q(Eigen::AngleAxisd(tilt, Vector3d::UnitY()));
  const Vector3d axis = q * Vector3d::UnitZ();
  spatial::Scene s;
  s.gravity = {0, 0, -p.g};
  s.step = 1e-4;
  const auto top = s.body({.name = "top",
                           .mass = p.mass,
                           .inertia = Vector3d(across, across, p.I3).asDiagonal(),
                           .position = p.l * axis,
                           .orientation = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).normalized(),
                           .omega = p.spin * axis});
  s.joint(spatial::Spherical{"tip", kGround, top, {0, 0, 0}, {0, 0, -p.l}});
  return s;
}

}  // namespace orthant

#include <orthant/core/scenes/bennett.h>

#include <array>
#include <cmath>
#include <numbers>

namespace orthant {

spatial::Scene bennett(const Bennett& p) {
  constexpr double kThin = 1e-6;  // axial over transverse moment of inertia
  const double alpha = p.twist * std::numbers::pi / 180, beta = std::asin(p.b / p.a * std::sin(alpha));
  const double theta2 =
      2 * std::atan(std::sin((alpha + beta) / 2) / std::sin((beta - alpha) / 2) / std::tan(p.theta1 / 2));
  const std::array<double, 4> theta{p.theta1, theta2, -p.theta1, -theta2}, length{p.a, p.b, p.a, p.b},
      twist{alpha, beta, alpha, beta};
  spatial::Scene s;
  s.gravity = {p.gx, p.gy, p.gz};
  s.duration = 5, s.step = 1e-3;
  struct Hinge {
    Vector3d x, axis;
  };
  std::array<Hinge, 4> hinge;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < 4; ++i) {
    hinge[i] = {T.translation(), T.linear().col(2)};
    T = T * Eigen::AngleAxisd(theta[i], Vector3d::UnitZ());
    const Eigen::Quaterniond q = Eigen::Quaterniond(T.linear()).normalized();
    const double mass = length[i], J = mass * length[i] * length[i] / 12;
    if (i < 3)
      s.body({.name = "rod" + std::to_string(i + 1),
              .mass = mass,
              .inertia = Vector3d(kThin * J, J, J).asDiagonal(),
              .position = T * Vector3d(length[i] / 2, 0, 0),
              .orientation = {q.w(), q.x(), q.y(), q.z()}});
    T = T * Eigen::Translation3d(length[i], 0, 0) * Eigen::AngleAxisd(twist[i], Vector3d::UnitX());
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const BodyId a = i == 0 ? kGround : static_cast<BodyId>(i) - 1, b = i < 3 ? static_cast<BodyId>(i) : kGround;
    const auto from = [&](BodyId body, const Vector3d& x, bool direction) -> Vector3d {
      if (body < 0) return x;
      const spatial::Body& of = s.bodies[static_cast<std::size_t>(body)];
      return quaternions::matrix_of(of.orientation).transpose() * (direction ? x : Vector3d(x - of.position));
    };
    const Hinge& h = hinge[i];
    spatial::Revolute joint{"hinge" + std::to_string(i + 1),
                            a,
                            b,
                            from(a, h.x, false),
                            from(b, h.x, false),
                            from(a, h.axis, true),
                            from(b, h.axis, true)};
    if (i == 0) joint.reference_a = {1, 0, 0}, joint.reference_b = {1, 0, 0};
    joint.axis_a.normalize(), joint.axis_b.normalize();
    s.joint(joint);
  }
  return s;
}

}  // namespace orthant

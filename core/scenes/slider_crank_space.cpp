#include <orthant/core/scenes/slider_crank_space.h>

namespace orthant {

spatial::Scene slider_crank_space(const SliderCrankSpace& p) {
  using namespace spatial;
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(p.turn_z, Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(p.turn_y, Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(p.turn_x, Vector3d::UnitX());
  spatial::Scene s;
  s.gravity = turn * Vector3d(0, -p.g, 0);
  s.duration = 0.2, s.step = 1e-5;
  const auto body = [&](const char* name, double mass, const Vector3d& J, const Vector2d& x, double angle,
                        const Vector2d& v, double omega) {
    const Eigen::Quaterniond q = turn * Eigen::AngleAxisd(angle, Vector3d::UnitZ());
    return s.body({.name = name,
                   .mass = mass,
                   .inertia = J.asDiagonal(),
                   .position = turn * Vector3d(x.x(), x.y(), 0),
                   .orientation = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).normalized(),
                   .velocity = turn * Vector3d(v.x(), v.y(), 0),
                   .omega = turn * Vector3d(0, 0, omega)});
  };
  const auto rod_like = [](double J) { return Vector3d(J / 100, J, J); };
  const double tip = p.l1 * p.omega1;  // [m/s] upward velocity of the crankpin
  const auto crank = body("crank", p.m1, rod_like(p.J1), {p.l1 / 2, 0}, 0, {0, p.l1 / 2 * p.omega1}, p.omega1);
  const auto rod = body("rod", p.m2, rod_like(p.J2), {p.l1 + p.l2 / 2, 0}, 0, {0, tip + p.l2 / 2 * p.omega2}, p.omega2);
  const auto slider =
      body("slider", p.m3, Vector3d::Constant(p.J3), {p.l1 + p.l2, 0}, p.theta3, {0, tip + p.l2 * p.omega2}, p.omega3);
  const Vector3d z = turn * Vector3d::UnitZ(), x = turn * Vector3d::UnitX();
  s.joint(spatial::Revolute{"shaft", kGround, crank, {0, 0, 0}, {-p.l1 / 2, 0, 0}, z, {0, 0, 1}, x, {1, 0, 0}});
  s.joint(spatial::Revolute{"crankpin", crank, rod, {p.l1 / 2, 0, 0}, {-p.l2 / 2, 0, 0}});
  s.joint(spatial::Revolute{"wristpin", rod, slider, {p.l2 / 2, 0, 0}, {0, 0, 0}});
  const ContactLaw law{.mu = p.mu, .e = p.e, .e_t = p.e_t};
  const double wall = p.b + p.clearance;
  for (int i = 0; i < 4; ++i) {
    const double side = i < 2 ? 1 : -1;  // of the wall
    const auto corner = [&](const std::string& suffix, double across) {
      s.contact(SpherePlane{"corner" + std::to_string(i + 1) + suffix,
                            slider,
                            {i % 2 == 0 ? -p.a : p.a, side * p.b, across},
                            0,
                            kGround,
                            turn * Vector3d(0, side * wall, 0),
                            turn * Vector3d(0, -side, 0),
                            law});
    };
    if (p.width > 0)
      corner("a", -p.width / 2), corner("b", p.width / 2);
    else
      corner("", 0);
  }
  return s;
}

}  // namespace orthant

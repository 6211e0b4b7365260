#include <orthant/core/scenes/spatial_slider_crank.h>

namespace orthant {

spatial::Scene spatial_slider_crank(const SpatialSliderCrank& p) {
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  s.duration = 5, s.step = 1e-3;
  const Vector3d pin(0, 0.1, 0.2), end(0.2, 0, 0), along = (end - pin) / 0.3, square = Vector3d(0, 2, -1).normalized();
  const double rate = p.omega / 6;
  const Vector3d pin_rate = rate * Vector3d(0, -0.48, 0), turn = rate * Vector3d(1.92, -0.96, 0.48);
  Eigen::Matrix3d axes;
  axes << along, square, along.cross(square);
  const Eigen::Quaterniond q = Eigen::Quaterniond(axes).normalized();
  const auto crank = s.body({.name = "crank",
                             .mass = 0.12,
                             .inertia = Vector3d(1e-4, 1e-4, 1e-5).asDiagonal(),
                             .position = {0, 0.1, 0.16},
                             .velocity = pin_rate / 2,
                             .omega = {p.omega, 0, 0}});
  const auto rod = s.body({.name = "rod",
                           .mass = 0.5,
                           .inertia = Vector3d(p.rod_spin, 4e-3, 4e-3).asDiagonal(),
                           .position = (pin + end) / 2,
                           .orientation = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).normalized(),
                           .velocity = pin_rate + turn.cross(Vector3d((end - pin) / 2)),
                           .omega = turn});
  const auto slider = s.body({.name = "slider",
                              .mass = 2,
                              .inertia = Vector3d::Constant(1e-4).asDiagonal(),
                              .position = end,
                              .velocity = {0.24 * rate, 0, 0}});
  s.joint(spatial::Revolute{"shaft", kGround, crank, {0, 0.1, 0.12}, {0, 0, -0.04}, {1, 0, 0}, {1, 0, 0}});
  s.joint(spatial::Spherical{"crankpin", crank, rod, {0, 0, 0.04}, {-0.15, 0, 0}});
  if (p.hooke == 1)
    s.joint(spatial::Universal{"wristpin", rod, slider, {0.15, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}});
  else
    s.joint(spatial::Spherical{"wristpin", rod, slider, {0.15, 0, 0}, {0, 0, 0}});
  s.joint(spatial::Prismatic{"rail", kGround, slider, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  return s;
}

spatial::Scene slider_crank_clearance(const SliderCrankClearance& p) {
  spatial::Scene s = spatial_slider_crank({p.omega, p.rod_spin});
  s.joints.erase(s.joints.begin() + (p.at_crank == 1 ? 1 : 2));
  s.step = 1e-4;
  const ContactLaw law{.mu = p.mu, .e = p.e};
  spatial::Socket socket{"socket", 1, {0.15, 0, 0}, p.ball, 2, {0, 0, 0}, p.ball + p.clearance, law};
  if (p.at_crank == 1) socket.a = 0, socket.centre_a = {0, 0, 0.04}, socket.b = 1, socket.centre_b = {-0.15, 0, 0};
  s.contact(socket);
  if (p.guide > 0) {
    s.joints.pop_back();
    const double side = 0.03, opening = side + 2 * p.guide;  // [m]
    s.contact_set(spatial::block_in_channel(
        {.name = "guide", .a = 2, .size = {0.06, side, side}, .width = opening, .height = opening, .law = law}));
  }
  return s;
}

}  // namespace orthant

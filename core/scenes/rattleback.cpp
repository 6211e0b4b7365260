#include <orthant/core/scenes/rattleback.h>

#include <numbers>

namespace orthant {

spatial::Scene rattleback(const Rattleback& p) {
  const Vector3d semi_axes(0.2, 0.03, 0.02), centre(0, 0, 0.01);  // of the ellipsoid, above the centre of mass
  const Eigen::Vector4d turned = quaternions::exponential(Vector3d(p.tilt * std::numbers::pi / 180, 0, 0)).normalized();
  const Eigen::Matrix3d R = quaternions::matrix_of(turned);
  Eigen::Matrix3d J = Vector3d(2e-4, 1.6e-3, 1.7e-3).asDiagonal();
  J(0, 1) = J(1, 0) = p.skew;
  const double height = semi_axes.cwiseProduct(R.transpose() * Vector3d::UnitZ()).norm() - (R * centre).z();
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  s.duration = 10, s.step = 1e-4;
  const Vector3d omega(0, 0, p.spin), lever = -semi_axes.cwiseAbs2().cwiseProduct(R.transpose() * Vector3d::UnitZ()) /
                                              semi_axes.cwiseProduct(R.transpose() * Vector3d::UnitZ()).norm();
  const auto stone = s.body({.name = "stone",
                             .mass = 1,
                             .inertia = J,
                             .position = {0, 0, height},
                             .orientation = turned,
                             .velocity = -omega.cross(R * (centre + lever)),
                             .omega = omega});
  s.contact(spatial::EllipsoidPlane{
      .name = "table", .a = stone, .centre = centre, .semi_axes = semi_axes, .law = {.mu = p.mu}});
  return s;
}

}  // namespace orthant

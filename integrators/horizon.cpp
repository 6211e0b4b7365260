#include <orthant/integrators/horizon.h>

#include <cmath>
#include <limits>

namespace orthant {
namespace {

/// The time in which `speed` and `acceleration` cover `way`, or a little less.
double time_for(double way, double speed, double acceleration) {
  const double root = speed + std::sqrt(speed * speed + 2 * acceleration * way);
  return root > 0 ? 2 * way / root : std::numeric_limits<double>::infinity();
}

}  // namespace

double horizon(const System& system, const Kinematics& poses, const Eigen::VectorXd& v, const Eigen::VectorXd& a) {
  constexpr double kTurn = 0.5;  // [rad]
  double least = std::numeric_limits<double>::infinity();
  const auto of = [](const Eigen::VectorXd& x, BodyId body) -> Eigen::Vector3d {
    return body < 0 || x.size() == 0 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(x.segment<3>(3 * body));
  };
  const auto turning = [&](BodyId body) {
    least = std::min(least, time_for(kTurn, std::abs(of(v, body).z()), std::abs(of(a, body).z())));
  };
  for (const Contact& contact : system.scene().contacts) {
    if (const auto* corner = std::get_if<CornerWall>(&contact)) {
      if (corner->point.squaredNorm() > 0) turning(corner->a);
      turning(corner->b);
    } else if (const auto* wall = std::get_if<DiscWall>(&contact)) {
      if (wall->centre.squaredNorm() > 0) turning(wall->a);
      turning(wall->b);
    } else if (const auto* discs = std::get_if<DiscDisc>(&contact)) {
      if (discs->centre_a.squaredNorm() > 0) turning(discs->a);
      if (discs->centre_b.squaredNorm() > 0) turning(discs->b);
      const double distance = discs->gap(poses) + discs->radius_a + discs->radius_b;
      const auto relative = [&](const Eigen::VectorXd& x) {
        return (of(x, discs->a) - of(x, discs->b)).head<2>().norm();
      };
      least = std::min(least, time_for(distance / 2, relative(v), relative(a)));
    }
  }
  return least;
}

}  // namespace orthant

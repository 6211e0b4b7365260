#include <orthant/integrators/between_events/look_ahead.h>

#include <cmath>
#include <limits>

namespace orthant {
namespace {

/// The time in which `speed` and `acceleration` cover `way`, or a little less.
double time_for(double way, double speed, double acceleration) {
  const double root = speed + std::sqrt(speed * speed + 2 * acceleration * way);
  return root > 0 ? 2 * way / root : std::numeric_limits<double>::infinity();
}

Vector2d middle(const Polygon& corners) {
  Vector2d sum(0, 0);
  for (const Vector2d& corner : corners) sum += corner;
  return sum / static_cast<double>(corners.size());
}

double outer_radius(const Polygon& corners) {
  double most = 0;
  for (const Vector2d& corner : corners) most = std::max(most, (corner - middle(corners)).norm());
  return most;
}

double inner_radius(const Polygon& corners) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d along = corners[(i + 1) % corners.size()] - corners[i], to = middle(corners) - corners[i];
    least = std::min(least, std::abs(along.x() * to.y() - along.y() * to.x()) / along.norm());
  }
  return least;
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
  const auto turning_about = [&](BodyId body, const Vector2d& point) {
    if (point.squaredNorm() > 0) turning(body);
  };
  const auto moving = [&](BodyId one, BodyId other, double way) {
    const auto relative = [&](const Eigen::VectorXd& x) { return (of(x, one) - of(x, other)).head<2>().norm(); };
    least = std::min(least, time_for(way, relative(v), relative(a)));
  };
  const auto centres = [&](BodyId one, const Vector2d& p, BodyId other, const Vector2d& q) {
    return (poses.at(one).x + poses.at(one).turn(p) - poses.at(other).x - poses.at(other).turn(q)).norm();
  };
  const auto look = [&](const auto& c) {
    using Kind = std::decay_t<decltype(c)>;
    if constexpr (std::is_same_v<Kind, CornerWall>) {
      turning_about(c.a, c.point), turning(c.b);
    } else if constexpr (std::is_same_v<Kind, DiscWall>) {
      turning_about(c.a, c.centre), turning(c.b);
    } else if constexpr (std::is_same_v<Kind, DiscDisc> || std::is_same_v<Kind, Journal>) {
      turning_about(c.a, c.centre_a), turning_about(c.b, c.centre_b);
      if constexpr (std::is_same_v<Kind, DiscDisc>)
        moving(c.a, c.b, centres(c.a, c.centre_a, c.b, c.centre_b) / 2);
      else
        moving(c.a, c.b, (c.radius_b - c.radius_a) / 2);
    } else if constexpr (std::is_same_v<Kind, DiscPolygon>) {
      turning_about(c.a, c.centre), turning(c.b);
      moving(c.a, c.b, centres(c.a, c.centre, c.b, middle(c.corners)) / 2);
    } else if constexpr (std::is_same_v<Kind, PolygonPolygon>) {
      turning(c.a), turning(c.b);
      const double size_a = outer_radius(c.corners_a), size_b = outer_radius(c.corners_b);
      const double apart = centres(c.a, middle(c.corners_a), c.b, middle(c.corners_b)) - size_a - size_b;
      const double thin = std::min(inner_radius(c.corners_a), inner_radius(c.corners_b)) / 2;
      const auto fast = [&](const Eigen::VectorXd& x) {
        const Eigen::Vector3d one = of(x, c.a), other = of(x, c.b);
        return std::hypot(one.x() - other.x(), one.y() - other.y()) + size_a * std::abs(one.z()) +
               size_b * std::abs(other.z());
      };
      const double within = time_for(thin, fast(v), fast(a));
      least = std::min(least, apart > thin ? std::max(within, time_for(apart, fast(v), fast(a))) : within);
    } else if constexpr (std::is_same_v<Kind, CustomContact>) {
      turning(c.a), turning(c.b);
      moving(c.a, c.b, c.length() / 2);
    } else if (!std::holds_alternative<Angle>(c.of.kind())) {
      std::visit([&](const auto& along) { turning(along.a), turning(along.b); }, c.of.kind());
    }
  };
  for (const Contact& contact : system.scene().contacts) std::visit(look, contact);
  return least;
}

}  // namespace orthant

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

double horizon(const System& system, std::span<const int> contacts, const Kinematics& poses, const Eigen::VectorXd& v,
               const Eigen::VectorXd& a) {
  constexpr double kTurn = 0.5;  // [rad]
  double least = std::numeric_limits<double>::infinity();
  const auto of = [](const Eigen::VectorXd& x, BodyId body) { return x.size() == 0 ? Twist{} : twist_of(x, body); };
  const auto turning = [&](BodyId body) {
    least = std::min(least, time_for(kTurn, std::abs(of(v, body).omega), std::abs(of(a, body).omega)));
  };
  const auto turning_about = [&](BodyId body, const Vector2d& point) {
    if (point.squaredNorm() > 0) turning(body);
  };
  // Of the point r of a body, turned into the world already: its velocity; its acceleration.
  const auto speed = [&](BodyId body, const Vector2d& r) -> Vector2d { return of(v, body).at(r); };
  const auto acceleration = [&](BodyId body, const Vector2d& r) -> Vector2d {
    if (a.size() == 0) return {0, 0};
    const double omega = of(v, body).omega;
    return of(a, body).at(r) - omega * omega * r;
  };
  /// Two points; `way`: of their distance, how far they may move.
  const auto moving = [&](BodyId one, const Vector2d& p, BodyId other, const Vector2d& q, const auto& way) {
    const Vector2d r_p = poses.at(one).turn(p), r_q = poses.at(other).turn(q);
    least = std::min(least, time_for(way((poses.at(one).x + r_p - poses.at(other).x - r_q).norm()),
                                     (speed(one, r_p) - speed(other, r_q)).norm(),
                                     (acceleration(one, r_p) - acceleration(other, r_q)).norm()));
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
      moving(c.a, c.centre_a, c.b, c.centre_b, [&](double far) {
        return std::is_same_v<Kind, Journal> ? (c.radius_b - c.radius_a) / 2
                                             : std::max(far / 2, far - c.radius_a - c.radius_b);
      });
    } else if constexpr (std::is_same_v<Kind, DiscPolygon>) {
      turning_about(c.a, c.centre), turning(c.b);
      moving(c.a, c.centre, c.b, middle(c.corners), [](double far) { return far / 2; });
    } else if constexpr (std::is_same_v<Kind, PolygonPolygon>) {
      turning(c.a), turning(c.b);
      const Vector2d p = middle(c.corners_a), q = middle(c.corners_b);
      const double size_a = outer_radius(c.corners_a), size_b = outer_radius(c.corners_b);
      const double apart = centres(c.a, p, c.b, q) - size_a - size_b;
      const double thin = std::min(inner_radius(c.corners_a), inner_radius(c.corners_b)) / 2;
      const auto fast = [&](const Eigen::VectorXd& x, const auto& at) {
        return (at(c.a, poses.at(c.a).turn(p)) - at(c.b, poses.at(c.b).turn(q))).norm() +
               size_a * std::abs(of(x, c.a).omega) + size_b * std::abs(of(x, c.b).omega);
      };
      const double within = time_for(thin, fast(v, speed), fast(a, acceleration));
      least = std::min(
          least, apart > thin ? std::max(within, time_for(apart, fast(v, speed), fast(a, acceleration))) : within);
    } else if constexpr (std::is_same_v<Kind, CustomContact>) {
      turning(c.a), turning(c.b);
      moving(c.a, {0, 0}, c.b, {0, 0}, [&](double) { return c.length() / 2; });
    } else if (!std::holds_alternative<Angle>(c.of.kind())) {
      std::visit([&](const auto& along) { turning(along.a), turning(along.b); }, c.of.kind());
      if (const auto* span = std::get_if<Span>(&c.of.kind()))
        moving(span->a, span->point_a, span->b, span->point_b, [&](double far) { return std::max(far, c.bound) / 2; });
    }
  };
  for (const int c : contacts) std::visit(look, system.scene().contacts[static_cast<std::size_t>(c)]);
  return least;
}

}  // namespace orthant

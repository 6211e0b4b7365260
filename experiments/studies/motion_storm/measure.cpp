#include "experiments/studies/motion_storm/measure.h"

#include "experiments/studies/motion_storm/place.h"

#include <algorithm>
#include <cmath>

namespace orthant::motion_storm {
namespace {

using Eigen::VectorXd;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// The largest distance, over the faces of p, at which all of r's corners lie beyond it.
double beyond_faces(const Polygon& p, const Polygon& r) {
  double most = -kFar;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector2d along = (p[(i + 1) % p.size()] - p[i]).normalized(), out(along.y(), -along.x());
    double least = kFar;
    for (const Vector2d& corner : r) least = std::min(least, out.dot(corner - p[i]));
    most = std::max(most, least);
  }
  return most;
}

double distance_to(const Polygon& p, const Vector2d& x) {
  double nearest = kFar;
  bool inside = true;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector2d side = p[(i + 1) % p.size()] - p[i], from = x - p[i];
    const double part = std::clamp(from.dot(side) / side.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (from - part * side).norm());
    inside = inside && side.x() * from.y() - side.y() * from.x() >= 0;
  }
  return inside ? -nearest : nearest;
}

double thickness(const Polygon& p) {
  double least = kFar;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector2d along = (p[(i + 1) % p.size()] - p[i]).normalized(), in(-along.y(), along.x());
    double deep = 0;
    for (const Vector2d& corner : p) deep = std::max(deep, in.dot(corner - p[i]));
    least = std::min(least, deep);
  }
  return least;
}

struct Gap {
  Place at;
  double operator()(const CornerWall& c) const {
    return at.turn(c.b, c.normal).dot(at.at(c.a, c.point) - at.at(c.b, c.wall_point));
  }
  double operator()(const DiscWall& c) const {
    return at.turn(c.b, c.normal).dot(at.at(c.a, c.centre) - at.at(c.b, c.wall_point)) - c.radius;
  }
  double operator()(const DiscDisc& c) const {
    return (at.at(c.a, c.centre_a) - at.at(c.b, c.centre_b)).norm() - c.radius_a - c.radius_b;
  }
  double operator()(const Journal& c) const {
    return c.radius_b - c.radius_a - (at.at(c.a, c.centre_a) - at.at(c.b, c.centre_b)).norm();
  }
  double operator()(const DiscPolygon& c) const {
    return distance_to(at.at(c.b, c.corners), at.at(c.a, c.centre)) - c.radius;
  }
  double operator()(const PolygonPolygon& c) const {
    const Polygon a = at.at(c.a, c.corners_a), b = at.at(c.b, c.corners_b);
    return std::max(beyond_faces(a, b), beyond_faces(b, a));
  }
  double operator()(const Limit& c) const {
    return c.side == Limit::Side::lower ? at.value(c.of) - c.bound : c.bound - at.value(c.of);
  }
  double operator()(const CustomContact& c) const {
    const auto* limit = c.target<RelationLimit>();
    if (limit == nullptr) return kFar;
    const double value = at.value(limit->sum);
    return limit->side == Limit::Side::lower ? value - limit->bound : limit->bound - value;
  }
};

struct Residual {
  Place at;
  double t;
  double apart(const auto& j) const { return (at.at(j.a, j.point_a) - at.at(j.b, j.point_b)).norm(); }
  double operator()(const Revolute& j) const { return apart(j); }
  double operator()(const Fixed& j) const {
    return std::max(apart(j), std::abs(at.angle(j.a) - at.angle(j.b) - j.angle));
  }
  double operator()(const Prismatic& j) const {
    const Vector2d across = at.turn(j.a, Vector2d(-j.axis.y(), j.axis.x()));
    return std::max(std::abs(across.dot(at.at(j.b, j.point_b) - at.at(j.a, j.point_a))),
                    std::abs(at.angle(j.b) - at.angle(j.a) - j.angle));
  }
  double operator()(const Distance& j) const { return std::abs(apart(j) - j.length); }
  double operator()(const Drive& j) const {
    const TimeLaw& s = j.law;
    return std::abs(at.value(j.of) - s.offset - s.rate_of_change * t - s.amplitude * std::sin(s.omega * t + s.phase));
  }
  double operator()(const CustomJoint& j) const {
    const auto* relation = j.target<Relation>();
    return relation != nullptr ? std::abs(at.value(relation->sum) - relation->offset) : 0;
  }
};

}  // namespace

double Measure::gap(const Contact& contact, const VectorXd& q) const { return std::visit(Gap{{q}}, contact); }

double Measure::residual(const Joint& joint, double t, const VectorXd& q) const {
  return std::visit(Residual{{q}, t}, joint);
}

double Measure::kinetic(const VectorXd& v) const {
  double sum = 0;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(3 * i);
    sum += scene_.bodies[i].mass * (v[k] * v[k] + v[k + 1] * v[k + 1]) / 2;
    sum += scene_.bodies[i].inertia * v[k + 2] * v[k + 2] / 2;
  }
  return sum;
}

double Measure::potential(const VectorXd& q) const {
  const Place at{q};
  double sum = 0;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(3 * i);
    sum -= scene_.bodies[i].mass * (scene_.gravity.x() * q[k] + scene_.gravity.y() * q[k + 1]);
  }
  for (const Spring& spring : scene_.springs)
    std::visit(
        [&](const auto& s) {
          double stretch = -s.rest;
          if constexpr (requires { s.of; })
            stretch += at.value(s.of);
          else if constexpr (requires { s.point_a; })
            stretch += (at.at(s.a, s.point_a) - at.at(s.b, s.point_b)).norm();
          else
            stretch += at.angle(s.a) - at.angle(s.b);
          sum += s.stiffness * stretch * stretch / 2;
        },
        spring);
  for (const Load& l : scene_.loads) sum -= l.force.dot(at.at(l.body, l.point)) + l.torque * at.angle(l.body);
  return sum;
}

double Measure::reach(BodyId body) const {
  const Body& of = scene_.bodies[static_cast<std::size_t>(body)];
  double most = std::sqrt(of.inertia / of.mass);  // of a wheel on a pin nothing else tells the size
  const auto take = [&](BodyId b, const Vector2d& p, double radius = 0) {
    if (b == body) most = std::max(most, p.norm() + radius);
  };
  for (const Contact& contact : scene_.contacts)
    std::visit(
        [&](const auto& c) {
          if constexpr (requires { c.corners_b; }) {
            for (const Vector2d& p : c.corners_a) take(c.a, p);
            for (const Vector2d& p : c.corners_b) take(c.b, p);
          } else if constexpr (requires { c.corners; }) {
            take(c.a, c.centre, c.radius);
            for (const Vector2d& p : c.corners) take(c.b, p);
          } else if constexpr (requires { c.centre_b; }) {
            take(c.a, c.centre_a, c.radius_a), take(c.b, c.centre_b, c.radius_b);
          } else if constexpr (requires { c.radius; }) {
            take(c.a, c.centre, c.radius);
          } else if constexpr (requires { c.point.norm(); }) {
            take(c.a, c.point);
          }
        },
        contact);
  for (const Joint& joint : scene_.joints)
    std::visit(
        [&](const auto& j) {
          if constexpr (requires { j.point_a; }) take(j.a, j.point_a), take(j.b, j.point_b);
        },
        joint);
  return most;
}

double Measure::width(const Contact& contact) const {
  if (const auto* c = std::get_if<DiscDisc>(&contact)) return 2 * std::min(c->radius_a, c->radius_b);
  if (const auto* c = std::get_if<DiscPolygon>(&contact)) return std::min(2 * c->radius, thickness(c->corners));
  if (const auto* c = std::get_if<PolygonPolygon>(&contact))
    return std::min(thickness(c->corners_a), thickness(c->corners_b));
  return kFar;
}

std::pair<BodyId, BodyId> Measure::pair(const Contact& contact) const {
  return std::visit([](const auto& c) { return std::pair<BodyId, BodyId>(bodies_of(c)); }, contact);
}

}  // namespace orthant::motion_storm

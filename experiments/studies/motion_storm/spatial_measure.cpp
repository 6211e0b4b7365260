#include "experiments/studies/motion_storm/spatial_measure.h"

#include <orthant/core/mechanics/dynamics/system.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant::motion_storm {
namespace {

using Eigen::Matrix3d;
using Eigen::VectorXd;
constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kFullTurn = 2 * std::numbers::pi;

/// A body's point or direction in the world.
struct SpatialPlace {
  const VectorXd& q;
  const std::vector<Matrix3d>& to_axes;  // body's frame → principal axes, whose quaternion q has
  Matrix3d turn(BodyId b) const {
    if (b < 0) return Matrix3d::Identity();
    const double *p = q.data() + 7 * b + 3, w = p[0], x = p[1], y = p[2], z = p[3];
    return (Matrix3d() << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),                //
            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))
               .finished() *
           to_axes[static_cast<std::size_t>(b)];
  }
  Vector3d turn(BodyId b, const Vector3d& p) const { return turn(b) * p; }
  Vector3d at(BodyId b, const Vector3d& p) const { return b < 0 ? p : Vector3d(q.segment<3>(7 * b) + turn(b, p)); }
  std::vector<Vector3d> at(BodyId b, const std::vector<Vector3d>& points) const {
    std::vector<Vector3d> all;
    for (const Vector3d& p : points) all.push_back(at(b, p));
    return all;
  }
  double value(const spatial::Coordinate& of) const {
    if (const auto* a = std::get_if<spatial::Angle>(&of)) {
      const auto zero = [](const Vector3d& reference, const Vector3d& axis) {
        return reference.isZero(0) ? spatial::perpendicular(axis) : reference;
      };
      const Vector3d x = turn(a->a, zero(a->reference_a, a->axis_a)), u = turn(a->a, a->axis_a), y = u.cross(x);
      const Vector3d d = turn(a->b, zero(a->reference_b, a->axis_b));
      return std::atan2(d.dot(y), d.dot(x));
    }
    if (const auto* s = std::get_if<spatial::Slide>(&of))
      return turn(s->a, s->axis).dot(at(s->b, s->point_b) - at(s->a, s->point_a));
    const auto& d = std::get<spatial::Span>(of);
    return (at(d.a, d.point_a) - at(d.b, d.point_b)).norm();
  }
  double off(const spatial::Coordinate& of, double wanted) const {
    return of.angle() ? std::remainder(value(of) - wanted, kFullTurn) : value(of) - wanted;
  }
};

struct Facet {
  Vector3d a, b, c, out;  // corners; unit normal
};
/// All triangles of corners that have no other corner outside.
std::vector<Facet> facets_of(const std::vector<Vector3d>& p) {
  std::vector<Facet> all;
  double size = 0;
  for (const Vector3d& x : p) size = std::max(size, (x - p[0]).norm());
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = i + 1; j < p.size(); ++j)
      for (std::size_t k = j + 1; k < p.size(); ++k) {
        Vector3d out = (p[j] - p[i]).cross(p[k] - p[i]);
        if (!(out.norm() > 1e-12 * size * size)) continue;
        out.normalize();
        double high = -kEndless, low = kEndless;
        for (const Vector3d& x : p) high = std::max(high, out.dot(x - p[i])), low = std::min(low, out.dot(x - p[i]));
        if (high <= 1e-9 * size) all.push_back({p[i], p[j], p[k], out});
        if (low >= -1e-9 * size) all.push_back({p[i], p[j], p[k], -out});
      }
  return all;
}

double to_segment(const Vector3d& x, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  return (x - a - std::clamp(d.dot(x - a) / d.squaredNorm(), 0.0, 1.0) * d).norm();
}
double to_triangle(const Vector3d& x, const Facet& f) {
  const Vector3d on = x - f.out.dot(x - f.a) * f.out;
  const double one = f.out.dot((f.b - f.a).cross(on - f.a)), two = f.out.dot((f.c - f.b).cross(on - f.b)),
               three = f.out.dot((f.a - f.c).cross(on - f.c));
  if ((one >= 0 && two >= 0 && three >= 0) || (one <= 0 && two <= 0 && three <= 0)) return (x - on).norm();
  return std::min({to_segment(x, f.a, f.b), to_segment(x, f.b, f.c), to_segment(x, f.c, f.a)});
}
double to_polytope(const Vector3d& x, const std::vector<Facet>& facets) {
  double beyond = -kEndless, nearest = kEndless;
  for (const Facet& f : facets) beyond = std::max(beyond, f.out.dot(x - f.a));
  if (beyond <= 0) return beyond;
  for (const Facet& f : facets) nearest = std::min(nearest, to_triangle(x, f));
  return nearest;
}

/// The least of a convex function on [0, 1], by golden section.
template <class F> double least(F&& f) {
  const double part = (std::sqrt(5.0) - 1) / 2;
  double lo = 0, hi = 1, x = hi - part * (hi - lo), y = lo + part * (hi - lo), fx = f(x), fy = f(y);
  double best = std::min({f(0.0), f(1.0), fx, fy});
  for (int i = 0; i < 45; ++i) {
    if (fx < fy) {
      hi = y, y = x, fy = fx, x = hi - part * (hi - lo), fx = f(x);
    } else {
      lo = x, x = y, fx = fy, y = lo + part * (hi - lo), fy = f(y);
    }
    best = std::min({best, fx, fy});
  }
  return best;
}

double along(const Vector3d& n, const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double low = kEndless, high = -kEndless;
  for (const Vector3d& x : a) low = std::min(low, n.dot(x));
  for (const Vector3d& x : b) high = std::max(high, n.dot(x));
  return low - high;
}
double between_polytopes(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double most = -kEndless;
  const auto take = [&](const Vector3d& n) { most = std::max({most, along(n, a, b), along(-n, a, b)}); };
  for (const Facet& f : facets_of(a)) take(f.out);
  for (const Facet& f : facets_of(b)) take(f.out);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = i + 1; j < a.size(); ++j)
      for (std::size_t k = 0; k < b.size(); ++k)
        for (std::size_t l = k + 1; l < b.size(); ++l) {
          const Vector3d u = a[j] - a[i], w = b[l] - b[k], n = u.cross(w);
          if (n.norm() > 1e-6 * u.norm() * w.norm()) take(n.normalized());
        }
  return most;
}

/// The largest of `sign` |P − its part along u| over a circle about c.
double extreme_of_rim(const Vector3d& c, const Vector3d& axis, double radius, const Vector3d& from, const Vector3d& u,
                      double sign) {
  const Vector3d e = spatial::perpendicular(axis), f = axis.cross(e);
  const auto value = [&](double phi) {
    const Vector3d d = c + radius * (std::cos(phi) * e + std::sin(phi) * f) - from;
    return sign * (d - u.dot(d) * u).norm();
  };
  constexpr int kPoints = 256;
  double best = -kEndless, where = 0;
  for (int i = 0; i < kPoints; ++i)
    if (const double phi = kFullTurn * i / kPoints; value(phi) > best) best = value(phi), where = phi;
  const double width = kFullTurn / kPoints;
  return std::max(best, -least([&](double s) { return -value(where + (2 * s - 1) * width); }));
}

/// c₂ − ratio c₁ − offset, known up to what full turns of its angles make: the value nearest to 0.
double off(const SpatialPlace& at, const spatial::Gear& j) {
  const double plain = at.value(j.second) - j.ratio * at.value(j.first) - j.offset;
  double nearest = kEndless;
  for (int one = -1000; one <= 1000; ++one) {
    const double turned = plain - (j.first.angle() ? j.ratio * kFullTurn * one : 0);
    const double rest = j.second.angle() ? std::remainder(turned, kFullTurn) : turned;
    if (std::abs(rest) < std::abs(nearest)) nearest = rest;
  }
  return nearest;
}

struct SpatialGap {
  SpatialPlace at;
  double above(const auto& c) const {
    return at.turn(c.b, c.normal).dot(at.at(c.a, c.centre) - at.at(c.b, c.plane_point));
  }
  double operator()(const spatial::SpherePlane& c) const { return above(c) - c.radius; }
  double operator()(const spatial::SphereSphere& c) const {
    return (at.at(c.a, c.centre_a) - at.at(c.b, c.centre_b)).norm() - c.radius_a - c.radius_b;
  }
  double operator()(const spatial::Socket& c) const {
    return c.radius_b - c.radius_a - (at.at(c.a, c.centre_a) - at.at(c.b, c.centre_b)).norm();
  }
  double operator()(const spatial::SphereBush& c) const {
    const Vector3d d = at.at(c.a, c.centre_a) - at.at(c.b, c.centre_b);
    return c.radius_b - c.radius_a - at.turn(c.b, c.axis_b).cross(d).norm();
  }
  double operator()(const spatial::EllipsoidPlane& c) const {
    const Vector3d n = at.turn(c.b, c.normal);
    double square = 0;
    for (int i = 0; i < 3; ++i) {
      const Vector3d axis =
          at.turn(c.a, Eigen::Quaterniond(c.orientation[0], c.orientation[1], c.orientation[2], c.orientation[3]) *
                           Vector3d::Unit(i));
      square += std::pow(c.semi_axes[i] * axis.dot(n), 2);
    }
    return above(c) - std::sqrt(square);
  }
  double operator()(const spatial::RimPlane& c) const {  // of its lowest point, whatever its phase
    return above(c) - c.radius * at.turn(c.b, c.normal).cross(at.turn(c.a, c.axis)).norm() - c.tube;
  }
  double operator()(const spatial::PinBush& c) const {
    const Vector3d u = at.turn(c.a, c.axis_a), w = at.turn(c.b, c.axis_b);
    const Vector3d pin = at.at(c.a, c.centre_a), bush = at.at(c.b, c.centre_b);
    if (c.rim_of_pin) return c.radius_b - extreme_of_rim(pin + c.along * u, u, c.radius_a, bush, w, 1);
    const Vector3d centre = bush + c.along * w;
    const double nearest = -extreme_of_rim(centre, w, c.radius_b, pin, u, -1);
    const Vector3d met = pin + u * (w.dot(centre - pin) / w.dot(u)) - centre;  // of the rim's plane and the pin's axis
    return (met.norm() > c.radius_b ? -nearest : nearest) - c.radius_a;
  }
  double operator()(const spatial::Limit& c) const {
    const double off = at.off(c.of, c.bound + c.beyond) + c.beyond;
    return c.side == spatial::Limit::Side::lower ? off : -off;
  }
  double operator()(const spatial::Backlash& c) const {
    return c.play / 2 + (c.flank == spatial::Limit::Side::lower ? 1 : -1) * off(at, c.gear);
  }
};

struct SpatialResidual {
  SpatialPlace at;
  double t;
  Vector3d line(const auto& j) const { return at.at(j.b, j.point_b) - at.at(j.a, j.point_a); }
  double apart(const auto& j) const { return line(j).norm(); }
  double beside(const auto& j, const Vector3d& axis) const { return at.turn(j.a, axis).cross(line(j)).norm(); }
  double tilted(const auto& j) const { return at.turn(j.a, j.axis_a).cross(at.turn(j.b, j.axis_b)).norm(); }
  double turned(const auto& j) const {
    const Matrix3d O =
        Eigen::Quaterniond(j.orientation[0], j.orientation[1], j.orientation[2], j.orientation[3]).toRotationMatrix();
    const Matrix3d off = at.turn(j.b).transpose() * at.turn(j.a) * O;
    return Vector3d(off(2, 1) - off(1, 2), off(0, 2) - off(2, 0), off(1, 0) - off(0, 1)).norm() / 2;
  }
  double operator()(const spatial::Spherical& j) const { return apart(j); }
  double operator()(const spatial::Revolute& j) const { return std::max(apart(j), tilted(j)); }
  double operator()(const spatial::Prismatic& j) const { return std::max(beside(j, j.axis), turned(j)); }
  double operator()(const spatial::Fixed& j) const { return std::max(apart(j), turned(j)); }
  double operator()(const spatial::Distance& j) const { return std::abs(apart(j) - j.length); }
  double operator()(const spatial::Drive& j) const {
    const TimeLaw& s = j.law;
    return std::abs(at.off(j.of, s.offset + s.rate_of_change * t + s.amplitude * std::sin(s.omega * t + s.phase)));
  }
  double operator()(const spatial::Cylindrical& j) const { return std::max(beside(j, j.axis_a), tilted(j)); }
  double operator()(const spatial::Universal& j) const {
    return std::max(apart(j), std::abs(at.turn(j.a, j.axis_a).dot(at.turn(j.b, j.axis_b))));
  }
  double operator()(const spatial::PlaneJoint& j) const {
    return std::max(std::abs(at.turn(j.a, j.axis_a).dot(line(j))), tilted(j));
  }
  double operator()(const spatial::PointInPlane& j) const { return std::abs(at.turn(j.a, j.axis).dot(line(j))); }
  double operator()(const spatial::PointOnLine& j) const { return beside(j, j.axis); }
  double operator()(const spatial::Screw& j) const {
    const double s = at.value(j.displacement()), theta = at.value(j.angle());
    return std::max({beside(j, j.axis_a), tilted(j),
                     std::abs(std::remainder(s - j.offset - j.pitch * theta / kFullTurn, j.pitch))});
  }
  double operator()(const spatial::Gear& j) const { return std::abs(off(at, j)); }
};

double thickness_of(const spatial::Shape& s) {
  if (!s.polytope()) return 2 * s.radius;
  double thin = kEndless;
  for (const Facet& f : facets_of(s.corners)) {
    double deep = 0;
    for (const Vector3d& x : s.corners) deep = std::max(deep, -f.out.dot(x - f.a));
    thin = std::min(thin, deep);
  }
  return thin;
}

}  // namespace

SpatialMeasure::SpatialMeasure(const spatial::Scene& scene) : scene_(scene) {
  const SystemOf<Spatial> system(scene);
  mass_ = system.mass();
  for (const spatial::Body& b : system.scene().bodies) to_axes_.push_back(b.to_axes);
}

double SpatialMeasure::gap(const spatial::Contact& contact, const VectorXd& q) const {
  return std::visit(SpatialGap{{q, to_axes_}}, contact);
}

double SpatialMeasure::gap(const spatial::Shape& a, const spatial::Shape& b, const VectorXd& q) const {
  if (a.polytope() && !b.polytope()) return gap(b, a, q);
  const SpatialPlace at{q, to_axes_};
  const auto p = at.at(a.body, a.corners), r = at.at(b.body, b.corners);
  const double radii = a.radius + b.radius;
  if (a.polytope()) return between_polytopes(p, r);
  const auto on_a = [&](double s) { return Vector3d((1 - s) * p.front() + s * p.back()); };
  if (b.polytope()) {
    const auto facets = facets_of(r);
    return least([&](double s) { return to_polytope(on_a(s), facets); }) - radii;
  }
  return least([&](double s) {
           return b.sphere() ? (on_a(s) - r[0]).norm() : to_segment(on_a(s), r.front(), r.back());
         }) -
         radii;
}

double SpatialMeasure::residual(const spatial::Joint& joint, double t, const VectorXd& q) const {
  return std::visit(SpatialResidual{{q, to_axes_}, t}, joint);
}

double SpatialMeasure::kinetic(const VectorXd& v) const { return mass_.dot(v.cwiseAbs2()) / 2; }

double SpatialMeasure::potential(const VectorXd& q) const {
  const SpatialPlace at{q, to_axes_};
  double sum = 0;
  for (Eigen::Index b = 0; 7 * b < q.size(); ++b) sum -= mass_[6 * b] * scene_.gravity.dot(q.segment<3>(7 * b));
  for (const spatial::Spring& spring : scene_.springs)
    std::visit(
        [&](const auto& s) {
          double stretch = 0;
          if constexpr (requires { s.of; })
            stretch = at.off(s.of, s.rest);
          else if constexpr (requires { s.point_a; })
            stretch = (at.at(s.a, s.point_a) - at.at(s.b, s.point_b)).norm() - s.rest;
          sum += s.stiffness * stretch * stretch / 2;
        },
        spring);
  for (const spatial::Load& l : scene_.loads)
    if (l.frame == spatial::Frame::world) sum -= l.force.dot(at.at(l.body, l.point));
  return sum;
}

double SpatialMeasure::reach(BodyId body) const {
  double most = std::sqrt(mass_.segment<3>(6 * body + 3).maxCoeff() / mass_[6 * body]);
  const auto take = [&](BodyId b, const Vector3d& p, double radius = 0) {
    if (b == body) most = std::max(most, p.norm() + radius);
  };
  for (const spatial::Contact& contact : scene_.contacts)
    std::visit(
        [&](const auto& c) {
          if constexpr (requires { c.semi_axes; })
            take(c.a, c.centre, c.semi_axes.maxCoeff());
          else if constexpr (requires { c.tube; })
            take(c.a, c.centre, c.radius + c.tube);
          else if constexpr (requires { c.along; })
            take(c.a, c.centre_a, c.radius_a + std::abs(c.along)),
                take(c.b, c.centre_b, c.radius_b + std::abs(c.along));
          else if constexpr (requires { c.radius_b; })
            take(c.a, c.centre_a, c.radius_a), take(c.b, c.centre_b, c.radius_b);
          else if constexpr (requires { c.radius; })
            take(c.a, c.centre, c.radius);
        },
        contact);
  for (const spatial::Joint& joint : scene_.joints)
    std::visit(
        [&](const auto& j) {
          if constexpr (requires { j.point_a; }) take(j.a, j.point_a), take(j.b, j.point_b);
        },
        joint);
  for (const spatial::Collision& c : scene_.collisions)
    for (const spatial::Shape& s : c.shapes)
      for (const Vector3d& corner : s.corners) take(s.body, corner, s.radius);
  return most;
}

double SpatialMeasure::width(const spatial::Contact& contact) const {
  const auto* c = std::get_if<spatial::SphereSphere>(&contact);
  return c != nullptr ? 2 * std::min(c->radius_a, c->radius_b) : kEndless;
}
double SpatialMeasure::width(const spatial::Shape& a, const spatial::Shape& b) const {
  return std::min(thickness_of(a), thickness_of(b));
}

std::pair<BodyId, BodyId> SpatialMeasure::pair(const spatial::Contact& contact) const {
  return std::visit(
      [](const auto& c) -> std::pair<BodyId, BodyId> {
        if constexpr (requires { c.of; })
          return std::visit([](const auto& of) { return std::pair{of.a, of.b}; }, c.of.kind());
        else if constexpr (requires { c.gear; })
          return {c.gear.a, c.gear.b};
        else
          return {c.a, c.b};
      },
      contact);
}

double SpatialMeasure::least_inertia(BodyId body) const { return mass_.segment<3>(6 * body + 3).minCoeff(); }

}  // namespace orthant::motion_storm

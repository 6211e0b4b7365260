// core/mechanics/spatial/coordinate.h — relative coordinate of two bodies, left free or constrained by a joint.
//
//   Angle   c = turn of b against a about `axis` (of a), from a's reference to b's     [rad], −π < c ≤ π
//   Slide   c = u · (P_b − P_a),  u = R_a axis                                         [m]
//   Span    c = |P_a − P_b|                                                            [m]; no direction at c = 0
// An Angle needs a joint that keeps the axes of a and b together. Its references are at right angles to the axes; where
// they are not given, both are perpendicular(axis), so that bodies with the same axis in both frames are at 0 when
// their frames are parallel, as in the plane. Values of an Angle are wrapped; Unwrapped counts full turns over time.
#pragma once

#include <orthant/core/mechanics/spatial/geometry.h>

#include <cmath>
#include <numbers>
#include <variant>

namespace orthant::spatial {

struct Angle {
  BodyId a = kGround, b = kGround;
  Vector3d axis_a{0, 0, 1}, axis_b{0, 0, 1};            // unit vectors in the bodies' frames
  Vector3d reference_a{0, 0, 0}, reference_b{0, 0, 0};  // likewise; zero: perpendicular(axis)

  double value(const Kinematics& k) const {
    const Vector3d u = k.at(a).turn(axis_a);
    const Vector3d from = k.at(a).turn(reference(axis_a, reference_a));
    const Vector3d to = k.at(b).turn(reference(axis_b, reference_b));
    return std::atan2(u.dot(from.cross(to)), from.dot(to));
  }
  Row row(const Kinematics& k) const { return turn_row(k, b, a, k.at(a).turn(axis_a)); }
  double bias(const Kinematics& k) const {
    return k.rate(a).omega.cross(k.at(a).turn(axis_a)).dot(k.rate(b).omega - k.rate(a).omega);
  }

 private:
  static Vector3d reference(const Vector3d& axis, const Vector3d& given) {
    return given.isZero(0) ? perpendicular(axis) : given;
  }
};

struct Slide {
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames
  Vector3d axis{1, 0, 0};                       // unit vector in a's frame

  double value(const Kinematics& k) const {
    return k.at(a).turn(axis).dot(k.at(b).x + k.at(b).turn(point_b) - k.at(a).x - k.at(a).turn(point_a));
  }
  Row row(const Kinematics& k) const {
    // The axis turns with a, so the rate is that of b's point against the point of a that coincides with it.
    const Vector3d r_b = k.at(b).turn(point_b);
    return pair_row(k, b, a, k.at(a).turn(axis), r_b, k.at(b).x + r_b - k.at(a).x);
  }
  double bias(const Kinematics& k) const {
    const Vector3d u = k.at(a).turn(axis), r_b = k.at(b).turn(point_b), r_a = k.at(a).turn(point_a);
    const Vector3d &wa = k.rate(a).omega, &wb = k.rate(b).omega;
    const Vector3d d = k.at(b).x + r_b - k.at(a).x - r_a, rate = k.rate(b).at(r_b) - k.rate(a).at(r_a);
    return u.dot(wb.cross(wb.cross(r_b)) - wa.cross(wa.cross(r_a))) + 2 * wa.cross(u).dot(rate) +
           wa.cross(wa.cross(u)).dot(d);
  }
};

struct Span {
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames

  double value(const Kinematics& k) const { return line(k).norm(); }
  Row row(const Kinematics& k) const {
    return pair_row(k, a, b, line(k).normalized(), k.at(a).turn(point_a), k.at(b).turn(point_b));
  }
  double bias(const Kinematics& k) const {
    const Vector3d d = line(k), n = d.normalized(), r_a = k.at(a).turn(point_a), r_b = k.at(b).turn(point_b);
    const Vector3d &wa = k.rate(a).omega, &wb = k.rate(b).omega;
    const double length = d.norm();
    const Vector3d rate = k.rate(a).at(r_a) - k.rate(b).at(r_b), across = rate - n.dot(rate) * n;
    return length > 0 ? n.dot(wa.cross(wa.cross(r_a)) - wb.cross(wb.cross(r_b))) + across.squaredNorm() / length : 0;
  }

 private:
  Vector3d line(const Kinematics& k) const {
    return k.at(a).x + k.at(a).turn(point_a) - k.at(b).x - k.at(b).turn(point_b);
  }
};

/// One of them, chosen by the scene.
struct Coordinate : std::variant<Angle, Slide, Span> {
  using variant::variant;
  double value(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.value(k); }, kind());
  }
  Row row(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.row(k); }, kind());
  }
  double bias(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.bias(k); }, kind());
  }
  bool angle() const { return std::holds_alternative<Angle>(kind()); }
  const variant& kind() const { return *this; }
};

/// c − wanted; of an angle the shorter way round.
inline double off(const Coordinate& of, const Kinematics& k, double wanted) {
  const double difference = of.value(k) - wanted;
  return of.angle() ? std::remainder(difference, 2 * std::numbers::pi) : difference;
}

/// An angle without jumps: of all values that differ by full turns the one next to where its last rates lead.
class Unwrapped {
 public:
  double add(double t, double value, double rate) {
    if (any_) {
      const double expected = value_ + (t - t_) * (rate_ + rate) / 2;
      value = expected + std::remainder(value - expected, 2 * std::numbers::pi);
    }
    any_ = true, t_ = t, value_ = value, rate_ = rate;
    return value_;
  }

 private:
  bool any_ = false;
  double t_ = 0, value_ = 0, rate_ = 0;  // [s, rad, rad/s]
};

}  // namespace orthant::spatial

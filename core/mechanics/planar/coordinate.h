// core/mechanics/planar/coordinate.h — relative coordinate of two bodies, left free or constrained by a joint.
//
//   Angle   c = θ_b − θ_a                           [rad]
//   Slide   c = u · (P_b − P_a),  u = R_a axis      [m]
//   Span    c = |P_a − P_b|                         [m]; no direction at c = 0: the row is zero there
// Limits, drives, springs and dry friction act along one of these; each needs its value, its row (ċ = row v) and the
// bias that is left of c̈ at zero acceleration.
#pragma once

#include <orthant/core/mechanics/planar/geometry.h>

#include <utility>
#include <variant>

namespace orthant {

struct Angle {
  BodyId a = kGround, b = kGround;

  double value(const Kinematics& k) const { return k.at(b).theta - k.at(a).theta; }
  Row row(const Kinematics& /*k*/) const { return {b, a, {0, 0, 1}, {0, 0, -1}}; }
  double bias(const Kinematics& /*k*/) const { return 0; }
};

struct Slide {
  BodyId a = kGround, b = kGround;
  Vector2d point_a{0, 0}, point_b{0, 0};  // [m] in the bodies' frames
  Vector2d axis{1, 0};                    // unit vector in a's frame

  double value(const Kinematics& k) const {
    return k.at(a).turn(axis).dot(k.at(b).x + k.at(b).turn(point_b) - k.at(a).x - k.at(a).turn(point_a));
  }
  Row row(const Kinematics& k) const {
    // The axis turns with a, so the rate is that of b's point against the point of a that coincides with it.
    const Vector2d r_b = k.at(b).turn(point_b);
    return pair_row(b, a, k.at(a).turn(axis), r_b, k.at(b).x + r_b - k.at(a).x);
  }
  double bias(const Kinematics& k) const {
    const Vector2d u = k.at(a).turn(axis), r_b = k.at(b).turn(point_b), r_a = k.at(a).turn(point_a);
    const double wa = k.rate(a).omega, wb = k.rate(b).omega;
    const Vector2d d = k.at(b).x + r_b - k.at(a).x - r_a, rate = k.rate(b).at(r_b) - k.rate(a).at(r_a);
    return u.dot(wa * wa * r_a - wb * wb * r_b) + 2 * wa * perp(u).dot(rate) - wa * wa * u.dot(d);
  }
};

struct Span {
  BodyId a = kGround, b = kGround;
  Vector2d point_a{0, 0}, point_b{0, 0};  // [m] in the bodies' frames

  double value(const Kinematics& k) const { return line(k).norm(); }
  Row row(const Kinematics& k) const {
    return pair_row(a, b, line(k).normalized(), k.at(a).turn(point_a), k.at(b).turn(point_b));
  }
  double bias(const Kinematics& k) const {
    const Vector2d d = line(k), n = d.normalized(), r_a = k.at(a).turn(point_a), r_b = k.at(b).turn(point_b);
    const double length = d.norm(), wa = k.rate(a).omega, wb = k.rate(b).omega;
    const double across = perp(n).dot(k.rate(a).at(r_a) - k.rate(b).at(r_b));
    return length > 0 ? n.dot(wb * wb * r_b - wa * wa * r_a) + across * across / length : 0;
  }

 private:
  Vector2d line(const Kinematics& k) const {
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
  const variant& kind() const { return *this; }
};

/// The two bodies of a joint, contact or spring: its own, or those of the coordinate or gear that it acts along.
template <class Element> std::pair<BodyId, BodyId> bodies_of(const Element& element) {
  if constexpr (requires { element.of; })
    return std::visit([](const auto& c) { return std::pair{c.a, c.b}; }, element.of.kind());
  else if constexpr (requires { element.gear; })
    return {element.gear.a, element.gear.b};
  else
    return {element.a, element.b};
}

}  // namespace orthant

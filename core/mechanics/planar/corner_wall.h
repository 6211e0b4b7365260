// core/mechanics/planar/corner_wall.h — corner-wall contact: a point of body a, a half-plane of body b (or the ground).
//   g = n · (P − W),  n = R_b normal (into the free side), P = x_a + R_a point, W = x_b + R_b wall_point   [m].
#pragma once

#include <orthant/core/mechanics/planar/contact_law.h>

#include <string>

namespace orthant {

struct CornerWall {
  std::string name;
  BodyId a = kGround;
  Vector2d point{0, 0};  // [m] in a's frame
  BodyId b = kGround;
  Vector2d wall_point{0, 0}, normal{0, 1};  // [m], unit; in b's frame
  ContactLaw law;

  double gap(const Kinematics& k) const {
    const Vector2d P = k.at(a).x + k.at(a).turn(point);
    if (b < 0) return normal.dot(P) - normal.dot(wall_point);
    return k.at(b).turn(normal).dot(P - k.at(b).x) - normal.dot(wall_point);
  }
  ContactRows rows(const Kinematics& k) const {
    const Vector2d n = k.at(b).turn(normal), r_a = k.at(a).turn(point), r_b = k.at(a).x + r_a - k.at(b).x;
    return {pair_row(a, b, n, r_a, r_b), pair_row(a, b, tangent_of(n), r_a, r_b)};
  }
  ContactBias bias(const Kinematics& k) const {
    const Vector2d n = k.at(b).turn(normal), t = tangent_of(n), r_a = k.at(a).turn(point);
    const Vector2d r_b = k.at(a).x + r_a - k.at(b).x, rate = k.rate(a).at(r_a) - k.rate(b).v;
    const double wa = k.rate(a).omega, wb = k.rate(b).omega;
    const Vector2d slip = rate - wb * perp(r_b);
    return {-wa * wa * n.dot(r_a) + 2 * wb * perp(n).dot(rate) - wb * wb * n.dot(r_b),
            wb * perp(t).dot(slip) - t.dot(wa * wa * r_a + wb * perp(rate))};
  }
};

}  // namespace orthant

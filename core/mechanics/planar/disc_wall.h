// core/mechanics/planar/disc_wall.h — disc-wall contact: a disc of body a, a half-plane of body b (or the ground).
//   g = n · (C − W) − radius,  C = x_a + R_a centre   [m]; the contact point is P = C − radius n.
#pragma once

#include <orthant/core/mechanics/planar/contact_law.h>

#include <string>

namespace orthant {

struct DiscWall {
  std::string name;
  BodyId a = kGround;
  Vector2d centre{0, 0};  // [m] in a's frame
  double radius = 1;      // [m] > 0
  BodyId b = kGround;
  Vector2d wall_point{0, 0}, normal{0, 1};  // [m], unit; in b's frame
  ContactLaw law;

  double gap(const Kinematics& k) const {
    return k.at(b).turn(normal).dot(k.at(a).x + k.at(a).turn(centre) - k.at(b).x) - normal.dot(wall_point) - radius;
  }
  ContactRows rows(const Kinematics& k) const {
    const Vector2d n = k.at(b).turn(normal), r_a = k.at(a).turn(centre) - radius * n;
    const Vector2d r_b = k.at(a).x + r_a - k.at(b).x;
    return {pair_row(a, b, n, r_a, r_b), pair_row(a, b, tangent_of(n), r_a, r_b)};
  }
  ContactBias bias(const Kinematics& k) const {
    const Vector2d n = k.at(b).turn(normal), t = tangent_of(n), r_c = k.at(a).turn(centre);
    const double wa = k.rate(a).omega, wb = k.rate(b).omega;
    const Vector2d r_b = k.at(a).x + r_c - radius * n - k.at(b).x;  // from b's centre to P
    const Vector2d centre_rate = k.rate(a).at(r_c) - k.rate(b).v, point_rate = centre_rate - wb * radius * perp(n);
    const Vector2d slip = centre_rate - wa * radius * perp(n) - wb * perp(r_b);
    return {-wa * wa * n.dot(r_c) + 2 * wb * perp(n).dot(centre_rate) - wb * wb * n.dot(r_b + radius * n),
            wb * perp(t).dot(slip) - t.dot(wa * wa * r_c + wb * perp(point_rate))};
  }
};

}  // namespace orthant

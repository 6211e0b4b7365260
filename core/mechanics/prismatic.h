// core/mechanics/prismatic.h — body b slides along an axis fixed in body a and keeps its angle to it.
//   Φ = [ n · (P_b − P_a),  θ_b − θ_a − angle ] = 0   [m, rad], n = R_a perp(axis), 2 rows.
#pragma once

#include <orthant/core/mechanics/geometry.h>

#include <string>

namespace orthant {

struct Prismatic {
  static constexpr int kRows = 2;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector2d point_a{0, 0}, point_b{0, 0};  // [m] in the bodies' frames
  Vector2d axis{1, 0};                    // unit vector in a's frame
  double angle = 0;                       // [rad] θ_b − θ_a

  void residual(const Kinematics& k, double* phi) const {
    const Vector2d n = k.at(a).turn(perp(axis));
    const Vector2d d = k.at(b).x + k.at(b).turn(point_b) - k.at(a).x - k.at(a).turn(point_a);
    phi[0] = n.dot(d);
    phi[1] = k.at(b).theta - k.at(a).theta - angle;
  }
  void rows(const Kinematics& k, Row* G) const {
    // n turns with a, so the rate is that of b's point against the point of a that coincides with it.
    const Vector2d n = k.at(a).turn(perp(axis)), r_b = k.at(b).turn(point_b);
    const Vector2d r_a = k.at(b).x + r_b - k.at(a).x;
    G[0] = pair_row(b, a, n, r_b, r_a);
    G[1] = {b, a, {0, 0, 1}, {0, 0, -1}};
  }
  void bias(const Kinematics& k, double* Gdot_v) const {
    const Vector2d n = k.at(a).turn(perp(axis)), r_b = k.at(b).turn(point_b), r_a = k.at(a).turn(point_a);
    const double wa = k.rate(a).omega, wb = k.rate(b).omega;
    const Vector2d d = k.at(b).x + r_b - k.at(a).x - r_a, rate = k.rate(b).at(r_b) - k.rate(a).at(r_a);
    Gdot_v[0] = n.dot(wa * wa * r_a - wb * wb * r_b) + 2 * wa * perp(n).dot(rate) - wa * wa * n.dot(d);
    Gdot_v[1] = 0;
  }
};

}  // namespace orthant

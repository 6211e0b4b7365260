// core/mechanics/planar/prismatic.h — prismatic joint: body b slides along an axis of body a and keeps its angle to it.
//   Φ = [ n · (P_b − P_a),  θ_b − θ_a − angle ] = 0   [m, rad], n = R_a perp(axis), 2 rows.
#pragma once

#include <orthant/core/mechanics/planar/coordinate.h>

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
    phi[0] = across().value(k);
    phi[1] = k.at(b).theta - k.at(a).theta - angle;
  }
  void rows(const Kinematics& k, Row* G) const {
    G[0] = across().row(k);
    G[1] = {b, a, {0, 0, 1}, {0, 0, -1}};
  }
  void bias(const Kinematics& k, double* Gdot_v) const {
    Gdot_v[0] = across().bias(k);
    Gdot_v[1] = 0;
  }

 private:
  Slide across() const { return {a, b, point_a, point_b, perp(axis)}; }
};

}  // namespace orthant

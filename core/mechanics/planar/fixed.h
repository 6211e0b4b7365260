// core/mechanics/planar/fixed.h — fixed joint (weld): a pin whose angle is constrained too.
//   Φ = [ x_a + R_a p_a − x_b − R_b p_b,  θ_a − θ_b − angle ] = 0   [m, m, rad], 3 rows.
#pragma once

#include <orthant/core/mechanics/planar/revolute.h>

namespace orthant {

struct Fixed {
  static constexpr int kRows = 3;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector2d point_a{0, 0}, point_b{0, 0};  // [m] in the bodies' frames
  double angle = 0;                       // [rad] θ_a − θ_b

  void residual(const Kinematics& k, double* phi) const {
    pin().residual(k, phi);
    phi[2] = k.at(a).theta - k.at(b).theta - angle;
  }
  void rows(const Kinematics& k, Row* G) const {
    pin().rows(k, G);
    G[2] = {a, b, {0, 0, 1}, {0, 0, -1}};
  }
  void bias(const Kinematics& k, double* Gdot_v) const {
    pin().bias(k, Gdot_v);
    Gdot_v[2] = 0;
  }

 private:
  Revolute pin() const { return {{}, a, b, point_a, point_b}; }
};

}  // namespace orthant

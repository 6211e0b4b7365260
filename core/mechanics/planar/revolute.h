// core/mechanics/planar/revolute.h — revolute joint (pin): one point of body a stays on one point of body b.
//   Φ = x_a + R_a p_a − x_b − R_b p_b = 0   [m], 2 rows.
#pragma once

#include <orthant/core/mechanics/planar/geometry.h>

#include <string>

namespace orthant {

struct Revolute {
  static constexpr int kRows = 2;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector2d point_a{0, 0}, point_b{0, 0};  // [m] in the bodies' frames

  /// Inline, so that rows() after it need not turn the points again.
  [[gnu::always_inline]] void residual(const Kinematics& k, double* phi) const {
    const Vector2d d = k.at(a).x + k.at(a).turn(point_a) - k.at(b).x - k.at(b).turn(point_b);
    phi[0] = d.x(), phi[1] = d.y();
  }
  void rows(const Kinematics& k, Row* G) const {
    const Vector2d r_a = k.at(a).turn(point_a), r_b = k.at(b).turn(point_b);
    G[0] = {a, b, {1, 0, -r_a.y()}, {-1, 0, r_b.y()}};
    G[1] = {a, b, {0, 1, r_a.x()}, {0, -1, -r_b.x()}};
  }
  void bias(const Kinematics& k, double* Gdot_v) const {  // Ġ v [m/s²]
    const double wa = k.rate(a).omega, wb = k.rate(b).omega;
    const Vector2d c = -wa * wa * k.at(a).turn(point_a) + wb * wb * k.at(b).turn(point_b);
    Gdot_v[0] = c.x(), Gdot_v[1] = c.y();
  }
};

}  // namespace orthant

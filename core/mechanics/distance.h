// core/mechanics/distance.h — a massless link: two points keep their distance.
//   Φ = |d| − length = 0   [m], d = P_a − P_b, 1 row. Needs length > 0 (the direction is lost at d = 0).
#pragma once

#include <orthant/core/mechanics/geometry.h>

#include <string>

namespace orthant {

struct Distance {
  static constexpr int kRows = 1;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector2d point_a{0, 0}, point_b{0, 0};  // [m] in the bodies' frames
  double length = 1;                      // [m] > 0

  void residual(const Kinematics& k, double* phi) const { phi[0] = line(k).norm() - length; }
  void rows(const Kinematics& k, Row* G) const {
    G[0] = pair_row(a, b, line(k).normalized(), k.at(a).turn(point_a), k.at(b).turn(point_b));
  }
  void bias(const Kinematics& k, double* Gdot_v) const {
    const Vector2d d = line(k), n = d.normalized(), r_a = k.at(a).turn(point_a), r_b = k.at(b).turn(point_b);
    const double wa = k.rate(a).omega, wb = k.rate(b).omega;
    const Vector2d rate = k.rate(a).at(r_a) - k.rate(b).at(r_b);
    const double across = perp(n).dot(rate);
    Gdot_v[0] = n.dot(wb * wb * r_b - wa * wa * r_a) + across * across / d.norm();
  }

 private:
  Vector2d line(const Kinematics& k) const {
    return k.at(a).x + k.at(a).turn(point_a) - k.at(b).x - k.at(b).turn(point_b);
  }
};

}  // namespace orthant

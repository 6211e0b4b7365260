// core/mechanics/spatial/distance.h — distance joint, a massless link: two points keep their distance.
//   Φ = |d| − length = 0   [m], d = P_a − P_b, 1 row. Needs length > 0 (the direction is lost at d = 0).
#pragma once

#include <orthant/core/mechanics/spatial/coordinate.h>

#include <string>

namespace orthant::spatial {

struct Distance {
  static constexpr int kRows = 1;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames
  double length = 1;                            // [m] > 0

  void residual(const Kinematics& k, double* phi) const { phi[0] = span().value(k) - length; }
  void rows(const Kinematics& k, Row* G) const { G[0] = span().row(k); }
  void bias(const Kinematics& k, double* Gdot_v) const { Gdot_v[0] = span().bias(k); }

 private:
  Span span() const { return {a, b, point_a, point_b}; }
};

}  // namespace orthant::spatial

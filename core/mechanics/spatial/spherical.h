// core/mechanics/spatial/spherical.h — spherical joint: one point of body a stays on one point of body b.
//   Φ = P_a − P_b = 0   [m], 3 rows.
#pragma once

#include <orthant/core/mechanics/spatial/constraint.h>

#include <string>

namespace orthant::spatial {

struct Spherical {
  static constexpr int kRows = 3;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames

  template <class F> void each(F&& f) const { f(Together{a, b, point_a, point_b}); }
  void residual(const Kinematics& k, double* phi) const { residual_of(*this, k, phi); }
  void rows(const Kinematics& k, Row* G) const { rows_of(*this, k, G); }
  void bias(const Kinematics& k, double* Gdot_v) const { bias_of(*this, k, Gdot_v); }
};

}  // namespace orthant::spatial

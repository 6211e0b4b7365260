// core/mechanics/spatial/universal.h — universal (Hooke) joint: one point together, and an axis of a at right angles
// to one of b.
//   Φ = [ P_a − P_b;  u_a · u_b ] = 0   [m, 1], 4 rows.
#pragma once

#include <orthant/core/mechanics/spatial/constraint.h>

#include <string>

namespace orthant::spatial {

struct Universal {
  static constexpr int kRows = 4;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames
  Vector3d axis_a{1, 0, 0}, axis_b{0, 1, 0};    // unit vectors in the bodies' frames

  template <class F> void each(F&& f) const {
    f(Together{a, b, point_a, point_b});
    f(Square{a, b, axis_a, axis_b});
  }
  void residual(const Kinematics& k, double* phi) const { residual_of(*this, k, phi); }
  void rows(const Kinematics& k, Row* G) const { rows_of(*this, k, G); }
  void bias(const Kinematics& k, double* Gdot_v) const { bias_of(*this, k, Gdot_v); }
};

}  // namespace orthant::spatial

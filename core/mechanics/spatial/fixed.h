// core/mechanics/spatial/fixed.h — fixed joint: body b keeps its place and orientation in body a.
//   Φ = [ P_a − P_b;  orientation ] = 0   [m, 1], 6 rows.
#pragma once

#include <orthant/core/mechanics/spatial/constraint.h>

#include <string>

namespace orthant::spatial {

struct Fixed {
  static constexpr int kRows = 6;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames
  Eigen::Vector4d orientation{1, 0, 0, 0};      // quaternion (w, x, y, z), b's frame → a's

  template <class F> void each(F&& f) const {
    f(Together{a, b, point_a, point_b});
    one_orientation(a, b, orientation, f);
  }
  void residual(const Kinematics& k, double* phi) const { residual_of(*this, k, phi); }
  void rows(const Kinematics& k, Row* G) const { rows_of(*this, k, G); }
  void bias(const Kinematics& k, double* Gdot_v) const { bias_of(*this, k, Gdot_v); }
};

}  // namespace orthant::spatial

// core/mechanics/spatial/plane_joint.h — planar joint: body b slides on a plane of body a and turns about its normal.
//   Φ = [ n · (P_b − P_a);  t1 · n_b;  t2 · n_b ] = 0   [m, 1], 3 rows; n = axis of a.
#pragma once

#include <orthant/core/mechanics/spatial/constraint.h>

#include <string>

namespace orthant::spatial {

struct PlaneJoint {
  static constexpr int kRows = 3;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames
  Vector3d axis_a{0, 0, 1}, axis_b{0, 0, 1};    // unit vectors in the bodies' frames
  Vector3d across{0, 0, 0};                     // perpendicular(axis_a); set by System

  template <class F> void each(F&& f) const {
    f(Across{{a, b, point_a, point_b, axis_a}});
    f(Parallel{a, b, axis_a, axis_b, across});
  }
  void residual(const Kinematics& k, double* phi) const { residual_of(*this, k, phi); }
  void rows(const Kinematics& k, Row* G) const { rows_of(*this, k, G); }
  void bias(const Kinematics& k, double* Gdot_v) const { bias_of(*this, k, Gdot_v); }
};

}  // namespace orthant::spatial

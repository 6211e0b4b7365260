// core/mechanics/spatial/cylindrical.h — cylindrical joint: body b slides along an axis of body a and turns about it.
//   Φ = [ t1 · (P_b − P_a);  t2 · (P_b − P_a);  t1 · u_b;  t2 · u_b ] = 0   [m, 1], 4 rows.
#pragma once

#include <orthant/core/mechanics/spatial/constraint.h>

#include <string>

namespace orthant::spatial {

struct Cylindrical {
  static constexpr int kRows = 4;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};          // [m] in the bodies' frames
  Vector3d axis_a{0, 0, 1}, axis_b{0, 0, 1};            // unit vectors in the bodies' frames
  Vector3d reference_a{0, 0, 0}, reference_b{0, 0, 0};  // of the angle, see coordinate.h
  Vector3d across{0, 0, 0};                             // perpendicular(axis_a); set by System

  template <class F> void each(F&& f) const {
    on_line(a, b, point_a, point_b, axis_a, across, f);
    f(Parallel{a, b, axis_a, axis_b, across});
  }
  void residual(const Kinematics& k, double* phi) const { residual_of(*this, k, phi); }
  void rows(const Kinematics& k, Row* G) const { rows_of(*this, k, G); }
  void bias(const Kinematics& k, double* Gdot_v) const { bias_of(*this, k, Gdot_v); }
  Angle angle() const { return {a, b, axis_a, axis_b, reference_a, reference_b}; }
  Slide displacement() const { return {a, b, point_a, point_b, axis_a}; }
};

}  // namespace orthant::spatial

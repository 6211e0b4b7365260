// core/mechanics/spatial/point_on_line.h — point on line: a point of body b stays on a line of body a.
//   Φ = [ t1 · (P_b − P_a);  t2 · (P_b − P_a) ] = 0   [m], 2 rows.
#pragma once

#include <orthant/core/mechanics/spatial/constraint.h>

#include <string>

namespace orthant::spatial {

struct PointOnLine {
  static constexpr int kRows = 2;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames
  Vector3d axis{1, 0, 0};                       // unit vector of the line, in a's frame
  Vector3d across{0, 0, 0};                     // perpendicular(axis); set by System

  template <class F> void each(F&& f) const { on_line(a, b, point_a, point_b, axis, across, f); }
  void residual(const Kinematics& k, double* phi) const { residual_of(*this, k, phi); }
  void rows(const Kinematics& k, Row* G) const { rows_of(*this, k, G); }
  void bias(const Kinematics& k, double* Gdot_v) const { bias_of(*this, k, Gdot_v); }
  Slide displacement() const { return {a, b, point_a, point_b, axis}; }
};

}  // namespace orthant::spatial

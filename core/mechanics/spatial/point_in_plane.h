// core/mechanics/spatial/point_in_plane.h — point in plane: a point of body b stays in a plane of body a.
//   Φ = n · (P_b − P_a) = 0   [m], 1 row.
#pragma once

#include <orthant/core/mechanics/spatial/constraint.h>

#include <string>

namespace orthant::spatial {

struct PointInPlane {
  static constexpr int kRows = 1;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames
  Vector3d axis{0, 0, 1};                       // unit normal of the plane, in a's frame

  template <class F> void each(F&& f) const { f(Across{{a, b, point_a, point_b, axis}}); }
  void residual(const Kinematics& k, double* phi) const { residual_of(*this, k, phi); }
  void rows(const Kinematics& k, Row* G) const { rows_of(*this, k, G); }
  void bias(const Kinematics& k, double* Gdot_v) const { bias_of(*this, k, Gdot_v); }
};

}  // namespace orthant::spatial

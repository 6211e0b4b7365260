// core/mechanics/spatial/spring.h — springs with dampers: between two points, and along a relative coordinate.
//
//   Point spring: tension  T = k (|d| − rest) + c n · ḋ along n = d / |d|,  d = P_a − P_b.
//   Joint spring: T = k (c − rest) + d ċ along a relative coordinate c of coordinate.h, against its growth; of an angle
//   the shorter way round from the rest.
// Generalized force −rowᵀ T, and to first order ΔT = k row Δq + c row Δv, as in planar/spring.h.
#pragma once

#include <orthant/core/mechanics/planar/spring.h>
#include <orthant/core/mechanics/spatial/coordinate.h>

#include <string>

namespace orthant::spatial {

using SpringState = SpringStateOf<Spatial>;

struct PointSpring {
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};  // [m] in the bodies' frames
  double stiffness = 0, damping = 0, rest = 0;  // [N/m] ≥ 0, [N s/m] ≥ 0, [m] ≥ 0

  SpringState evaluate(const Kinematics& k, const double* v) const {
    const Vector3d r_a = k.at(a).turn(point_a), r_b = k.at(b).turn(point_b);
    const Vector3d d = k.at(a).x + r_a - k.at(b).x - r_b;
    const double length = d.norm();
    const Vector3d n = length > 0 ? Vector3d(d / length) : Vector3d(1, 0, 0);  // any direction will do at length 0
    SpringState s{pair_row(k, a, b, n, r_a, r_b)};
    const double stretch = length - rest;
    s.tension = stiffness * stretch + damping * apply(s.row, v);
    s.energy = stiffness * stretch * stretch / 2;
    return s;
  }
};

struct JointSpring {
  std::string name;
  Coordinate of;
  double stiffness = 0, damping = 0, rest = 0;  // of an Angle [N m/rad], [N m s/rad], [rad]; else as point springs

  SpringState evaluate(const Kinematics& k, const double* v) const {
    SpringState s{of.row(k)};
    const double stretch = off(of, k, rest);
    s.tension = stiffness * stretch + damping * apply(s.row, v);
    s.energy = stiffness * stretch * stretch / 2;
    return s;
  }
};

}  // namespace orthant::spatial

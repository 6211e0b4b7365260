// core/mechanics/planar/spring.h — springs with dampers: between two points, between two angles, along a joint.
//
//   Point spring: tension  T = k (|d| − rest) + c n · ḋ along n = d / |d|,  d = P_a − P_b.
//   Torsion spring: torque τ = k (θ_a − θ_b − rest) + c (ω_a − ω_b).
//   Joint spring: T = k (c − rest) + d ċ along a relative coordinate c of coordinate.h, against its growth.
// All are a force law along one Row, which is their whole interface:
//   generalized force −rowᵀ T, and to first order ΔT = k row Δq + c row Δv. (The geometric stiffness T/|d| across
//   the spring is left out: it is of the order of the change of direction within a step.)
#pragma once

#include <orthant/core/mechanics/planar/coordinate.h>

#include <string>

namespace orthant {

template <class Space> struct SpringStateOf {
  RowOf<Space> row;
  double tension = 0, energy = 0;  // [N] or [N m]; [J]
  double damping = 0;              // of drag, whose coefficient changes with the velocity
};
using SpringState = SpringStateOf<Planar>;

struct PointSpring {
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector2d point_a{0, 0}, point_b{0, 0};        // [m] in the bodies' frames
  double stiffness = 0, damping = 0, rest = 0;  // [N/m] ≥ 0, [N s/m] ≥ 0, [m] ≥ 0

  SpringState evaluate(const Kinematics& k, const double* v) const {
    const Vector2d r_a = k.at(a).turn(point_a), r_b = k.at(b).turn(point_b);
    const Vector2d d = k.at(a).x + r_a - k.at(b).x - r_b;
    const double length = d.norm();
    const Vector2d n = length > 0 ? Vector2d(d / length) : Vector2d(1, 0);  // any direction will do at length 0
    SpringState s{pair_row(a, b, n, r_a, r_b)};
    const double stretch = length - rest;
    s.tension = stiffness * stretch + damping * apply(s.row, v);
    s.energy = stiffness * stretch * stretch / 2;
    return s;
  }
};

struct TorsionSpring {
  std::string name;
  BodyId a = kGround, b = kGround;
  double stiffness = 0, damping = 0, rest = 0;  // [N m/rad] ≥ 0, [N m s/rad] ≥ 0, [rad]

  SpringState evaluate(const Kinematics& k, const double* v) const {
    SpringState s{{a, b, {0, 0, 1}, {0, 0, -1}}};
    const double stretch = k.at(a).theta - k.at(b).theta - rest;
    s.tension = stiffness * stretch + damping * apply(s.row, v);
    s.energy = stiffness * stretch * stretch / 2;
    return s;
  }
};

struct JointSpring {
  std::string name;
  Coordinate of;
  double stiffness = 0, damping = 0, rest = 0;  // of an Angle as for torsion springs; else as for point springs

  SpringState evaluate(const Kinematics& k, const double* v) const {
    SpringState s{of.row(k)};
    const double stretch = of.value(k) - rest;
    s.tension = stiffness * stretch + damping * apply(s.row, v);
    s.energy = stiffness * stretch * stretch / 2;
    return s;
  }
};

}  // namespace orthant

// core/mechanics/planar/drive.h — driving constraint: a relative coordinate of two bodies is a given function of time.
//   Φ = c(q) − s(t) = 0   [rad or m], 1 row:  row v = ṡ,  row v̇ + bias − s̈ = 0.
// The motor does the required work, so energy is not conserved. The initial velocities should agree with ṡ(0).
#pragma once

#include <orthant/core/mechanics/planar/coordinate.h>
#include <orthant/core/mechanics/planar/time_law.h>

#include <string>

namespace orthant {

struct Drive {
  static constexpr int kRows = 1;
  std::string name;
  Coordinate of;
  TimeLaw law;

  void residual(const Kinematics& k, double* phi) const { phi[0] = of.value(k) - law.value(k.t); }
  void rows(const Kinematics& k, Row* G) const { G[0] = of.row(k); }
  void rate(const Kinematics& k, double* wanted) const { wanted[0] = law.rate(k.t); }
  void bias(const Kinematics& k, double* Gdot_v) const { Gdot_v[0] = of.bias(k) - law.acceleration(k.t); }
};

}  // namespace orthant

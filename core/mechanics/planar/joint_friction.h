// core/mechanics/planar/joint_friction.h — joint friction, dry, along a relative coordinate: bearing, brake, seal.
//   λ ∈ −B Sgn(ċ):  λ = −B sgn(ċ) while it moves, |λ| ≤ B while it sticks   [N m or N].
//   B = bound + mu radius R,   R the magnitude of the joint's reaction [N], see joint_load.h: of a revolute joint the
//   force on its pin, of a prismatic one the force across (its torque does not count).
// One box row −h B ≤ Λ ≤ h B of a step's problem. R is explicit, the mean of the previous step, which keeps the problem
// linear. The error is of first order, and an impact affects R in the step after it. The first step is repeated until R
// is that of this step.
#pragma once

#include <orthant/core/mechanics/planar/coordinate.h>

#include <string>

namespace orthant {

struct JointFriction {
  std::string name;
  Coordinate of;
  double bound = 0;   // [N m] of an Angle, [N] of the others; ≥ 0
  double mu = 0;      // ≥ 0 of the load
  double radius = 1;  // [m] > 0 of the pin; 1 where the friction is a force
  int joint = -1;     // whose load, revolute or prismatic, in the scene's order; read where mu > 0

  bool loaded() const { return mu > 0; }
  double bound_at(double load) const { return bound + mu * radius * load; }
};

}  // namespace orthant

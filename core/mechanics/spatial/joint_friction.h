// core/mechanics/spatial/joint_friction.h — joint friction, dry, along a relative coordinate: λ ∈ −bound Sgn(ċ).
// One box row −h bound ≤ Λ ≤ h bound of a step's problem, as in planar/joint_friction.h; the bound is constant.
#pragma once

#include <orthant/core/mechanics/spatial/coordinate.h>

#include <string>

namespace orthant::spatial {

struct JointFriction {
  std::string name;
  Coordinate of;
  double bound = 0;  // [N m] of an Angle, [N] of the others; ≥ 0

  bool loaded() const { return false; }  // it does not depend on a joint's reaction
  double bound_at(double /*load*/) const { return bound; }
};

}  // namespace orthant::spatial

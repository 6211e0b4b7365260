// core/mechanics/joint_friction.h — dry friction of given strength along a relative coordinate: a bearing, a brake, a seal.
//   λ ∈ −bound Sgn(ċ):  λ = −bound sgn(ċ) while it moves, |λ| ≤ bound while it sticks   [N m or N].
// The bound does not depend on the joint's load. One box row −h bound ≤ Λ ≤ h bound of a step's problem.
#pragma once

#include <orthant/core/mechanics/coordinate.h>

#include <string>

namespace orthant {

struct JointFriction {
  std::string name;
  Coordinate of;
  double bound = 0;  // [N m] of an Angle, [N] of the others; ≥ 0
};

}  // namespace orthant

// core/mechanics/contact_law.h — what every contact has besides its geometry.
#pragma once

#include <orthant/core/mechanics/geometry.h>

namespace orthant {

/// Coulomb friction and Newton restitution: ξ = γ⁺ + e γ⁻ in the normal and in the tangential direction.
struct ContactLaw {
  double mu = 0;   // friction coefficient ≥ 0; 0: no friction rows at all
  double e = 0;    // normal restitution in [0, 1]
  double e_t = 0;  // tangential restitution in [−1, 1]
};

/// Kinematics of a closed contact. The normal points from b to a; the tangent is t = −perp(n).
struct ContactRows {
  Row normal, tangent;  // rates of the gap and of slip [m/s]
};
struct ContactBias {
  double normal = 0, tangent = 0;  // d/dt of the two rates at zero acceleration [m/s²]
};

inline Vector2d tangent_of(const Vector2d& n) { return {n.y(), -n.x()}; }

}  // namespace orthant

// core/mechanics/scene/derivatives.h — derivative check: rows of joints and contacts against finite differences.
//
//   rows(q) = ∂Φ/∂q or ∂g/∂q,   rate(t) = −∂Φ/∂t,   bias(q, v, t) = d/dt (rows v − rate) along q̇ = v, v̇ = 0
// by central differences at the given poses of the bodies and at two others near them. A difference at all three is an
// error; at one alone the geometry may have a corner.   Differences of 1e-7 (of the bodies' distance, if less
// than 1 m), agreement to 1e-4 of the largest entry.
// check(scene) tests every custom element in this way; the tests of Orthant test every built-in one.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

namespace orthant {

/// Words for what is wrong, such as "rows[1] by the angle of body 0 is 0.5: differences of residual give -0.5"; empty:
/// right.
std::string wrong_derivative(const Joint& joint, const Kinematics& poses);
std::string wrong_derivative(const Contact& contact, const Kinematics& poses);

}  // namespace orthant

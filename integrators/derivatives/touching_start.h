// integrators/derivatives/touching_start.h — contacts that are closed at the start by a gap of 0, which a parameter
// opens.
//
//   A step of moreau-jean closes contacts with gap ≤ 0 at q + θ h v. Where that gap is 0 within rounding and a
//   parameter changes it, by the state or by the contact's geometry, the run has one-sided derivatives only. These are
//   of the side on which the contact stays as it is.
#pragma once

#include <orthant/integrators/derivatives/projection_linearization.h>

#include <vector>

namespace orthant {

/// Contacts, ascending. ahead: θ h of the first step [s]. q, v: the start's changes, one column a parameter, dof × p.
template <class Space> std::vector<int> touching_starts(const SystemOf<Space>& system, const State& start, double ahead,
                                                        const std::vector<ParameterChangeOf<Space>>& changes,
                                                        const DirectionBlock& q, const DirectionBlock& v);

}  // namespace orthant

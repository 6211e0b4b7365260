// experiments/studies/motion_storm/shared_load.h — static indeterminacy: friction that rigid contacts do not determine.
//
//   A box on a seam of two tiles stands on both ends of its face and on a corner of each tile at the seam: four normal
//   forces on one line, two equations (weight, moment). Where all tiles have the same μ, friction is μ m g whatever the
//   shares. Where the μ differ, each share is another friction force, and each is a solution of the model.
// Sliding contacts have the rows N and N + F, F = −σ μ T with σ the sign of the slip; joints and sticking contacts have
// rows G. Friction is left open where some z, with H = M⁻¹ [N + F; G]ᵀ z, has  [N; G] H = 0  and  H ≠ 0.
// In space F = −μ (u₁ T₁ + u₂ T₂) with u the direction of the slip: a spinning box stands on four corners, and its
// friction depends on their shares although all have the same μ.
#pragma once

#include "experiments/studies/motion_storm/trace.h"

namespace orthant::motion_storm {

/// A bound of what two solutions of the model can differ by at the end of the trace: places in sizes, angles in rad.
/// In each step a normal impulse P [N s] that goes over from one contact to another changes the friction on a body of
/// mass m by (max σμ − min σμ) P (in space: |μ u − μ' u'| P at the most), its speed by that over m, and its place by
/// that speed times the rest of the run. P is at most the sum of all normal impulses of the step. 0 where friction is
/// determined. Contacts of the last impact between two rows count, too, where the trace has events: from its time on.
double friction_left_open(const Scene& scene, const Trace& trace, double size);
double friction_left_open(const spatial::Scene& scene, const Trace& trace, double size);

}  // namespace orthant::motion_storm

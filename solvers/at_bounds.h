// solvers/at_bounds.h — z put exactly at the bounds that it is near to: the judge (judge/certify.h) excuses no distance.
#pragma once

#include <orthant/core/lcp/solution.h>

namespace orthant {

/// to ← s.z within the bounds, and at a bound where the way there is lost in rounding, or changes no w by more than the
/// w_i that asks for it; frictions after their normals. s.w and s.rounding as the judge leaves them. False: z is there.
/// widest: scratch, the largest |A_ij| of each column.
bool put_at_bounds(const Lcp& problem, const Solution& s, Vector& widest, Vector& to);

}  // namespace orthant

// solvers/at_bounds.h — bounds: moves a z near its bounds exactly to them, since the judge (judge/certify.h) accepts no
// distance.
#pragma once

#include <orthant/core/lcp/solution.h>

namespace orthant {

class AtBounds {  // reuse it: the members are scratch
 public:
  /// to ← s.z within the bounds, and at a bound where the way there, times A_ii (0: the column's largest entry), is
  /// lost in the rounding of the row, or is less than the w_i that asks for it; frictions after their normals. s.w as
  /// the judge leaves it. False: z is there already. Units of rows and columns make no difference.
  bool put(const Lcp& problem, const Solution& s, Vector& to);

 private:
  Vector stiff_, widest_, w_, size_, inner_, inner_size_;
};

}  // namespace orthant

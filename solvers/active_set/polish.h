// solvers/active_set/polish.h — polishing: the active rows of an approximate solution, solved exactly.
//
//   An optimization method ends near a solution, with z_i and w_i both small but neither zero. Here each row gets a
//   side (active_rows.h) and the system of this choice is solved. Rows with a wrong sign change sides, and this is
//   repeated a few times.
//   Where the system is singular the point next to the guess is taken. The point with the smaller residual is kept.
//   Guesses, until one is exact: the minimum map's choice; only rows clearly inside; all rows not clearly outside
//   (these two differ on degenerate rows, z_i = w_i = 0); the first one again, the point next to 0 (z may have run away
//   along a face of solutions).
//   Local by design: started far from a solution it ends there, or improves little.
//   Cost: 1 to 32 factorizations of a principal block, O(n³) dense. Problems without friction rows.
//   Source: Mehrotra & Ye, Math. Programming 62 (1993) 497-515 (the optimal face from an interior point).
#pragma once

#include <orthant/solvers/active_set/active_rows.h>
#include <orthant/solvers/at_bounds.h>
#include <orthant/solvers/budget.h>
#include <orthant/solvers/solver.h>

namespace orthant {

class Polish {  // reuse it
 public:
  /// z n: replaced by what is better by the judge's residual and rounding, within the bounds; not finite, it stays what
  /// it is. True when the judge, allowing for rounding only, calls the end solved. `problem` without friction rows.
  /// `each_row`: a z that the judge accepts row by row beats one that only has a smaller largest residual (the bounds
  /// of frozen friction settle better by the latter).
  bool improve(const Lcp& problem, Vector& z, const Budget& budget, bool each_row = false);

 private:
  bool better(const Lcp& problem, const Vector& z);
  void guess(const Lcp& problem, int kind, const Budget& budget);

  Judge judge_;
  Solution trial_, best_, put_;
  AtBounds at_bounds_;
  bool each_row_ = false;
  ActiveRows rows_;
  Vector zero_;
};

}  // namespace orthant

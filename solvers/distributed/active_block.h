// solvers/distributed/active_block.h — active rows over the ranks: the Newton step that a choice of sides defines.
//
//   lower: z_i = lo_i;  upper: z_i = hi_i;  inside (F): z_F ← z_F − A_FF⁻¹ w_F,  w = A z + b with the others at their
//   bounds. A_FF by a Krylov method to a tolerance: each step is a correction, so that errors of earlier steps vanish.
//   Rows stay on their rank: A_FF takes no communication but the halo's pattern. A rank without inside rows waits.
#pragma once

#include <orthant/solvers/active_set/active_rows.h>
#include <orthant/solvers/distributed/distributed_lcp.h>
#include <orthant/solvers/distributed/krylov.h>

#include <vector>

namespace orthant::distributed {

class ActiveBlock {
 public:
  ActiveBlock(const DistributedLcp& problem, Krylov& krylov) : problem_(problem), krylov_(krylov) {}

  std::vector<Side> side;  // m; own rows
  Vector z, w;             // m + h; m

  /// Sides as the minimum map chooses them at (z, w).
  void choose();
  /// Collective. z and w of the present choice, from the present z. False: the block could not be solved.
  bool step(double rtol);
  /// The side on which row i would be right: where z or w breaks its sign by more than rounding, the other one.
  Side better(Index i) const;

 private:
  bool same_choice() const;
  void extract();

  const DistributedLcp& problem_;
  Krylov& krylov_;
  std::vector<Side> of_block_;
  std::vector<PetscInt> inside_;  // own rows, in the whole problem's numbers
  bool extracted_ = false;
  double inside_of_all_ = 0;
  OwnedMat block_;
  Vector right_, part_, size_;
};

}  // namespace orthant::distributed

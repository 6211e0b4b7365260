// solvers/active_set/coarse_start.h — coarse-grid start of active-set methods: smaller problems of the same matrix.
//
//   The free boundary of an obstacle problem moves a few rows an iteration: from far away that takes a number of
//   iterations that grows with the grid. So the problem is first solved on part of its rows, as multigrid would:
//     coarse rows C    taken in order, each that is not yet the neighbour of one (strong: −a_ij ≥ ¼ max_k −a_ik)
//     interpolation P  z_i of another row: the mean of its strong neighbours in C, weighed with −a_ij, times
//                      Σ_j −a_ij / a_ii (all j);  coarse problem PᵀAP, Pᵀb, the bounds of C
//   and so on to less than 64 rows; then up again, each level starting from P z of the one below, with a few block
//   pivoting iterations.   O(nnz) for the setup and a few factorizations of each level: on grids about as many rows on
//   all of them together as on the finest.
//   block-pivot on the ball obstacle A19: 128² nodes 15 → 3 iterations (half the time), 256² 26 → 3 (a third); on 64²
//   8 → 7, and the setup costs more than it saves.
//   Only for sparse A with positive diagonal and no positive entry outside it (Z-matrices): else there is no start.
//   Source: Ruge & Stüben in McCormick (ed.), Multigrid Methods (1987), ch. 4; Hoppe, SIAM J. Numer. Anal. 24 (1987).
#pragma once

#include <orthant/solvers/active_set/active_rows.h>
#include <orthant/solvers/budget.h>

#include <Eigen/SparseCore>

#include <vector>

namespace orthant {

class CoarseStart {
 public:
  /// z ← P z of the coarse problem; false, and z as it was, where there is none. No friction rows.
  bool guess(const Lcp& problem, const Budget& budget, Vector& z);

 private:
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  bool interpolation(const Lcp& fine, Sparse& P, std::vector<int>& coarse) const;
  void solve(const Lcp& problem, const Budget& budget, Vector& z, bool guessed);
  ActiveRows rows_;
};

}  // namespace orthant

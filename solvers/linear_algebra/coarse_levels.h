// solvers/linear_algebra/coarse_levels.h — algebraic multigrid levels of a sparse matrix, with rows left out.
//
//   Level 0 is A. From level l to the next (Ruge & Stüben's direct interpolation):
//     strong   j of row i: −a_ij ≥ ¼ max_k −a_ik
//     C        rows taken in order, each that is not yet a strong neighbour of one; a row without strong neighbours is
//              none of them: sweeps solve it
//     P        row i in C: 1;  else P_ij = −a_ij s_i / (d_i c_i), j in C and strong;  s_i, c_i: sums of the −a_ik > 0
//              of all k and of those j, d_i = a_ii + the sum of the a_ik > 0, k ≠ i
//     matrix   Pᵀ A P
//   down to 8 rows or to where rows hardly become fewer.   O(nnz). On grids of five points all matrices Pᵀ A P
//   together have 1.2 times the entries of A (stretched: 2.2), of seven points in space 1.5 times; all P 0.8 times.
//   Truncation: rows that are held at their bounds leave the correction. truncate() makes T = Pᵀ I A I P of all levels
//   below, I the unit matrix without those rows, and computes only the rows of T again that have changed since.
//   correct(): one V-cycle on the T, a Gauss-Seidel sweep forward before the coarse correction, backward after it.
//   Sources: Ruge & Stüben in McCormick (ed.), Multigrid Methods (1987), ch. 4; Gräser & Kornhuber, J. Comput. Math. 27
//   (2009) 1-44 (truncation).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/budget.h>

#include <deque>
#include <vector>

namespace orthant {

/// y = A x, each row's sum in the order of its entries.
void product_with(const RowSparse& A, const Vector& x, Vector& y);

class CoarseLevels {
 public:
  /// Levels of A, which must outlive them, as the budget must. Fewer once that is exhausted; corrections are 0 then.
  void build(const RowSparse& A, const Budget& budget);
  void build(const RowSparse& A, const Budget&& temporary) = delete;

  std::size_t count() const { return count_; }  // at least 1
  const RowSparse& matrix(std::size_t level) const { return level == 0 ? *finest_ : levels_[level].A; }
  /// The row of each coarse row on its level; of levels that have a next one.
  const std::vector<int>& coarse(std::size_t level) const { return levels_[level].coarse; }
  void restrict_to_coarse(std::size_t level, const Vector& fine, Vector& coarse) const;  // Pᵀ
  void interpolate(std::size_t level, const Vector& coarse, Vector& fine) const;         // P
  /// Entries of the matrices and interpolations of all levels below the finest.
  std::size_t entries() const;

  /// `held`: 1 for the rows of `level` that are left out. All levels below are truncated for it.
  void truncate(std::size_t level, const std::vector<char>& held);
  /// c ≈ −A⁻¹ w on the rows of `level` that are not held, from the levels below; 0 on the others.
  void correct(std::size_t level, const Vector& w, Vector& c);

 private:
  struct Level {
    RowSparse A, P, R;        // R = Pᵀ
    std::vector<int> coarse;  // of the next level
    std::vector<double> T;    // values of A, truncated
    std::vector<char> dirty;  // rows of T that have changed
    std::vector<int> place;   // of a coarse row among them; or of a column in the row that is formed
    Vector x, r;
  };
  bool coarsen(std::size_t level);
  void interpolation(std::size_t level);
  bool product(std::size_t level, const Budget& budget);   // A of the next level
  void truncated_product(std::size_t level, bool finest);  // T of the next level, dirty rows
  void cycle(std::size_t level);                           // x ← ≈ T⁻¹ r

  const RowSparse* finest_ = nullptr;
  const Budget* budget_ = nullptr;
  std::deque<Level> levels_;
  std::size_t count_ = 0;
  std::size_t truncated_ = 0;  // for this level
  bool fresh_ = true;          // no truncation since build()
  std::vector<char> held_;
};

}  // namespace orthant

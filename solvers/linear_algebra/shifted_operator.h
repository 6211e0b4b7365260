// solvers/linear_algebra/shifted_operator.h — solves with A + s I, A = L Lᵀ a scaled Delassus operator, in the space of
// its columns.
//
//   L = D W M⁻¹ᐟ², n × m. For s > 0, by Woodbury's formula:
//     (L Lᵀ + s I)⁻¹ b = (b − L (s I + Lᵀ L)⁻¹ Lᵀ b) / s
//   Lᵀ L has a row for each coordinate of the bodies, not for each row of W: a tower of planks with four contacts a
//   face has far fewer of them.
// Error: about 1e-16 ‖A‖ / s of the result's size. Cost: one factorization by CHOLMOD a shift; a solve takes two
// products with L more.
// Source: Golub & Van Loan, Matrix Computations (2013), 2.1.4.
#pragma once

#include <orthant/solvers/linear_algebra/sparse_cholesky.h>

#include <vector>

namespace orthant {

class ShiftedOperator {
 public:
  /// Row i of L is row[i] of A's W, times its entry of `scale`. A has no R, and M⁻¹ ≥ 0. False: the columns that have
  /// entries are so many that the space of the rows is as good; nothing is loaded.
  bool load(const Delassus& A, const std::vector<int>& row, const Vector& scale);
  /// s > 0. False: SparseCholesky::factorize() says so.
  bool factorize(double s, const Budget* budget);
  /// x ← (L Lᵀ + s I)⁻¹ x. False when there is no memory left.
  bool solve(Vector& x);

 private:
  void form();

  RowSparse L_, columns_;      // Lᵀ
  RowSparse K_;                // s I + Lᵀ L
  std::vector<int> diagonal_;  // its places
  std::vector<int> place_;     // of each column of W, −1: it has no entries
  double shift_ = 0;           // on the diagonal of K_
  SparseCholesky cholesky_;
  Vector inner_;
  std::vector<double> sum_;  // scratch: a row of K
  std::vector<int> filled_;
};

}  // namespace orthant

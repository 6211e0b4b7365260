// solvers/linear_algebra/sparse_cholesky.h — sparse Cholesky factorization within a time budget.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/support/cholmod_factor.h>
#include <orthant/solvers/budget.h>

namespace orthant {

class SparseCholesky {
 public:
  /// A symmetric (only its upper triangle is read), columns ascending. False when it is not positive definite, with NaN
  /// too, or a pivot is ≤ zero times the largest, or the budget (null: none) cannot afford it. A is analysed
  /// only where its pattern is not that of the last call.
  bool factorize(const RowSparse& A, double zero, const Budget* budget = nullptr);

  /// x ← A⁻¹ x, |A| numbers, after a factorize() that was true. False when there is no memory left.
  bool solve(Vector& x);

 private:
  CholmodFactor factor_;
  std::vector<int> start_, column_;  // what factor_ was analysed for
};

}  // namespace orthant

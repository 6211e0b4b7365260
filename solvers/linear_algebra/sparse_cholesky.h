// solvers/linear_algebra/sparse_cholesky.h — sparse Cholesky factorization by CHOLMOD (SuiteSparse).
//
//   Approximate minimum degree, then row by row: on a grid of 128 x 128 with the reference BLAS twice as fast as
//   CHOLMOD's dense blocks, and 2.4 times as fast as UMFPACK (whole runs of block-pivot).
//   Source: Chen, Davis, Hager & Rajamanickam, ACM Trans. Math. Softw. 35 (2008), Algorithm 887.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/budget.h>

#include <cholmod.h>

namespace orthant {

class SparseCholesky {
 public:
  SparseCholesky();
  ~SparseCholesky();
  SparseCholesky(const SparseCholesky&) = delete;
  SparseCholesky& operator=(const SparseCholesky&) = delete;

  /// A symmetric (only its upper triangle is read), columns ascending. False when it is not positive definite, with NaN
  /// too, or a pivot is ≤ zero times the largest, or the budget (null: none) cannot afford it. A is analysed
  /// only where its pattern is not that of the last call.
  bool factorize(const RowSparse& A, double zero, const Budget* budget = nullptr);

  /// x ← A⁻¹ x, |A| numbers, after a factorize() that was true. False when there is no memory left.
  bool solve(Vector& x);

 private:
  cholmod_common common_{};
  std::vector<int> start_, column_;  // what factor_ was analysed for
  cholmod_factor* factor_ = nullptr;
  double operations_ = 0;  // that a factorization takes
  cholmod_dense *solution_ = nullptr, *work1_ = nullptr, *work2_ = nullptr;
};

}  // namespace orthant

// core/lcp/definite.h — matrices in one sparse form with error bounds, and a proof of positive definiteness.
//
//   formed(A): the entries of any storage; those of a Delassus operator carry the rounding of the product.
//   surely_definite(S, c): λ_min of the symmetric part is > c, proved. Cholesky (CHOLMOD, sparse) of D S D − s I, D powers
//   of 2 that bring the diagonal near 1: where it runs to its end in floating point, λ_min > 0 without the shift
//     s ≥ γ/(1 − γ) tr(D S D) + ‖error‖∞,   γ = (n + 2) ε.
//   Cost: a sparse Cholesky factorization. `false` says nothing: that the matrix is not definite needs a witness.
//   Source: Rump, BIT 46 (2006), Verification of positive definiteness.
#pragma once

#include <orthant/core/lcp/problem.h>

namespace orthant {

struct Formed {
  using Sparse = Eigen::SparseMatrix<double>;
  Sparse value, error;  // n × n; |true entry − value| ≤ error, which is empty (all zero) where A is stored by entries
};
Formed formed(const Matrix& A);

/// (A + Aᵀ)/2, errors and the rounding of the sum included.
Formed symmetric_part(const Formed& A);

/// `symmetric` as symmetric_part() gives it.
bool surely_definite(const Formed& symmetric, double above = 0);

}  // namespace orthant

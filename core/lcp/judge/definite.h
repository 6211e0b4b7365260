// core/lcp/judge/definite.h — definiteness and M-matrix proofs, in one sparse form with error bounds.
//
//   formed(A): the entries of any storage; those of a Delassus operator carry the rounding of the product.
//   surely_definite(S, c): λ_min of the symmetric part is > c, proved. Cholesky (CHOLMOD, sparse) of D S D − s I, D
//   powers of 2 that bring the diagonal near 1: where it runs to its end in floating point, λ_min > 0 without the shift
//     s ≥ γ/(1 − γ) tr(D S D) + ‖error‖∞,   γ = (n + 2) ε.
//   Cost: a sparse Cholesky factorization. `false` proves nothing: a witness is required to show that the matrix is not
//   definite.
//   surely_m_matrix(A, d): d > 0 with ⟨A⟩ d > 0, ⟨A⟩ = |A_ii| on the diagonal, −|A_ij| off it, proves ⟨A⟩⁻¹ ≥ 0. One
//   sparse LU.
//   Sources: Berman & Plemmons, Nonnegative Matrices in the Mathematical Sciences (1979), ch. 6; Rump, BIT 46 (2006),
//   Verification of positive definiteness.
#pragma once

#include <orthant/core/lcp/judge/exact.h>

#include <vector>

namespace orthant {

struct Formed {
  using Sparse = Eigen::SparseMatrix<double>;
  Sparse value, error;  // n × n; |true entry − value| ≤ error, which is empty (all zero) where A is stored by entries
};
Formed formed(const Matrix& A);

/// (A + Aᵀ)/2, errors and the rounding of the sum included.
Formed symmetric_part(const Formed& A);

/// Visits (i, j, A_ij as exact::Filtered), column by column.
template <class Visit> void for_each_entry(const Formed& A, Visit&& visit) {
  for (Index j = 0; j < A.value.outerSize(); ++j) {
    Formed::Sparse::InnerIterator e(A.error, j);
    for (Formed::Sparse::InnerIterator it(A.value, j); it; ++it) {
      exact::Filtered entry(it.value());
      while (e && e.row() < it.row()) ++e;
      if (e && e.row() == it.row()) entry.error = e.value();
      visit(it.row(), j, entry);
    }
  }
}
exact::Filtered entry(const Formed& A, Index i, Index j);

/// ⟨A⟩ and, with all errors counted, ⟨A⟩ v.
Formed::Sparse comparison(const Formed& A);
std::vector<exact::Filtered> comparison_times(const Formed& A, const Eigen::VectorXd& v);

/// d as LU gives it for ⟨A⟩ d = e. `false` says nothing.
bool surely_m_matrix(const Formed& A, const Eigen::VectorXd& d);

/// `symmetric` as symmetric_part() gives it.
bool surely_definite(const Formed& symmetric, double above = 0);

}  // namespace orthant

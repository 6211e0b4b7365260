// core/support/cholmod_factor.h — factors of sparse symmetric matrices of one pattern, by CHOLMOD (SuiteSparse).
//
//   Approximate minimum degree, then row by row: on a grid of 128 x 128 with the reference BLAS twice as fast as
//   CHOLMOD's dense blocks, and 2.4 times as fast as UMFPACK (whole runs of block-pivot).
//   Source: Chen, Davis, Hager & Rajamanickam, ACM Trans. Math. Softw. 35 (2008), Algorithm 887.
#pragma once

#include <cholmod.h>

#include <span>

namespace orthant {

/// Column j of a symmetric matrix holds (index[k], value[k]) for start[j] ≤ k < start[j + 1], ascending. What is below
/// the diagonal is not read.
struct SymmetricColumns {
  std::span<const int> start, index;
  std::span<const double> value;
};

class CholmodFactor {
 public:
  CholmodFactor();
  ~CholmodFactor();
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  /// Finds the order of the columns and the pattern of the factor. Values are not read. False: no memory.
  bool analyse(const SymmetricColumns& A);
  double operations() const { return operations_; }  // of a factorization

  /// A = L Lᵀ, of the pattern that was analysed. False when it is not positive definite, with NaN too, or a pivot is
  /// ≤ zero times the largest.
  bool factorize(const SymmetricColumns& A, double zero);

  /// x ← A⁻¹ x after a factorize() that was true. False when there is no memory left.
  bool solve(std::span<double> x);

  /// After a factorize() that was true: each pivot L_ii² over its A_ii, `diagonal`, that is what is left of a row after
  /// those before it were taken out.
  void pivot_shares(std::span<const double> diagonal, std::span<double> shares) const;

 private:
  cholmod_common common_{};
  cholmod_factor* factor_ = nullptr;
  double operations_ = 0;
  cholmod_dense *solution_ = nullptr, *work1_ = nullptr, *work2_ = nullptr;
};

}  // namespace orthant

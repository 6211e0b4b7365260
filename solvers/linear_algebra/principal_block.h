// solvers/linear_algebra/principal_block.h — principal blocks: linear systems (A_FF + D) x = r, F and the
// diagonal D changing from iteration to iteration.
//
//   dense storage    Cholesky when A is symmetric and the block positive definite, else LU with partial pivoting, or
//                    with complete pivoting where that lets entries grow
//   sparse storage   Cholesky (CHOLMOD) when A is symmetric and the block positive definite, else LU (UMFPACK)
//   A Delassus operator is formed as a dense matrix, since these methods factorize its principal blocks.
// A block that is singular to working precision, as its pivots show it, is reported, never solved (UMFPACK: only one
// that is exactly singular); with D given, only one that is exactly singular.  While F stays, so does the order of a
// sparse elimination: it is analysed once.  Dense blocks of up to about 64 rows allocate nothing once the largest has
// been seen; complete pivoting and sparse blocks do.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/budget.h>

#include <memory>
#include <vector>

namespace orthant {

class PrincipalBlock {
 public:
  PrincipalBlock();
  ~PrincipalBlock();
  PrincipalBlock(const PrincipalBlock&) = delete;
  PrincipalBlock& operator=(const PrincipalBlock&) = delete;

  /// The matrix of the following calls, which must outlive them (a Delassus operator is copied). So must the budget,
  /// null:
  /// none. Once it is over no factorization is begun, and a dense one with partial pivoting is given up.
  void load(const Matrix& A, const Budget* budget = nullptr);

  /// False when the block is singular or not finite, or the budget is over. F ascends; empty is fine. D = diag(shift_F)
  /// from the n numbers of `shift`, which must outlive the solves; null: 0. The block of the last call, unshifted both,
  /// is not factorized again.
  bool factorize(const std::vector<Index>& F, const Vector* shift = nullptr);

  /// x ← (A_FF + D)⁻¹ r for the last block, both of |F| entries; one step of refinement, dense with the residual in
  /// long double, unless the caller's own iteration corrects x.
  void solve(const Vector& r, Vector& x, bool refine = true);

 private:
  struct Dense;
  struct Sparse;
  std::unique_ptr<Dense> dense_;
  std::unique_ptr<Sparse> sparse_;
  bool is_sparse_ = false;
  bool usable_ = false;  // the factors are those of F_ without a shift
  const Budget* budget_ = nullptr;
  std::vector<Index> F_;
};

}  // namespace orthant

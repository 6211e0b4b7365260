// solvers/principal_block.h — linear systems A_FF x = r with principal blocks, F changing from iteration to iteration.
//
//   dense storage    Cholesky when A is symmetric and the block positive definite, else LU with partial pivoting (Eigen)
//   sparse storage   UMFPACK (SuiteSparse), which picks a symmetric strategy by itself where the pattern suggests it
//   A Delassus operator is formed as a dense matrix: principal blocks are what these methods live on.
// A block that is singular to working precision is reported, never solved. Up to 64 rows a dense block is embedded in an
// n × n one with ones on the diagonal: then the size never changes, and nothing is allocated after the first call.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <memory>
#include <vector>

namespace orthant {

class PrincipalBlock {
 public:
  PrincipalBlock();
  ~PrincipalBlock();
  PrincipalBlock(const PrincipalBlock&) = delete;
  PrincipalBlock& operator=(const PrincipalBlock&) = delete;

  /// The matrix of the following calls, which must outlive them (a Delassus operator is copied).
  void load(const Matrix& A);

  /// False when A_FF is singular or not finite. F ascends; empty is fine.
  bool factorize(const std::vector<Index>& F);

  /// x ← A_FF⁻¹ r for the last F, both of |F| entries; one step of refinement with the residual in long double.
  void solve(const Vector& r, Vector& x);

 private:
  struct Dense;
  struct Sparse;
  std::unique_ptr<Dense> dense_;
  std::unique_ptr<Sparse> sparse_;
  bool is_sparse_ = false, symmetric_ = false;
  std::vector<Index> F_;
};

}  // namespace orthant

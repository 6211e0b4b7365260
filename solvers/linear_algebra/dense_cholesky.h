// solvers/linear_algebra/dense_cholesky.h — dense Cholesky factorization A = L Lᵀ, in place.
//
//   m³/6 multiplications (Eigen's); a solve m². Nothing is allocated once the largest size has been seen, up to about
//   64 rows (beyond, Eigen's products take room for themselves).
#pragma once

#include <orthant/core/lcp/problem.h>

#include <Eigen/Cholesky>

namespace orthant {

class DenseCholesky {  // reuse it
 public:
  DenseMatrix A;  // m × m, to be filled before factorize(); its lower triangle is read

  /// False when A is not positive definite, with NaN too, or a pivot is ≤ zero times the largest.
  bool factorize(double zero) {
    if (A.rows() == 0) return true;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factored(A);
    const auto L = A.diagonal().array();
    return factored.info() == Eigen::Success && L.square().minCoeff() > zero * L.square().maxCoeff();
  }

  /// x ← A⁻¹ x, m numbers.
  template <class Derived> void solve(Eigen::MatrixBase<Derived>& x) const {
    A.triangularView<Eigen::Lower>().solveInPlace(x);
    A.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
  }
};

}  // namespace orthant

// solvers/derivatives/active_system.h — linear system of an active pattern: (Pᵀ A E + D) y = r, factorized once.
//
//   dense A      Cholesky where the block is symmetric positive definite, else LU with partial pivoting
//   sparse A     Cholesky (CHOLMOD) likewise, else LU (KLU)
//   Delassus     never formed: with u = M⁻¹ Wᵀ E y the saddle-point system, sparse, by KLU
//                  [ I      −M⁻¹ Wᵀ E   ] [u]   [0]
//                  [ Pᵀ W   Pᵀ R E + D  ] [y] = [r]
//   Rows and columns are scaled by their largest entries first. Singular means: 1-norm condition, estimated, above
//   1 / (16 ε √n). Then y is the solution of least norm of the scaled system, and of the least residual where there is
//   no solution:
//     A symmetric, E = P   proximal steps y ← y + (B + δ I)⁻¹ (r − B y) from 0, δ = 1e-7, by the factorizations above
//     else, dense          a complete orthogonal decomposition
//     else                 proximal steps y ← y + (BᵀB + α² I)⁻¹ Bᵀ (r − B y) from 0, α = 1e-6, by the sparse LU of
//                          [ α I  B ; Bᵀ  −α I ]
//   The steps end where the residual falls no longer by a tenth.
//   Sources: Golub & Van Loan, Matrix Computations (4th ed., 2013), ch. 5.4, 6.1; Higham, Accuracy and Stability of
//   Numerical Algorithms (2nd ed., 2002), algorithm 15.1 (condition estimate).
#pragma once

#include <orthant/core/lcp/problem.h>

#include <Eigen/SparseCore>
#include <memory>

namespace orthant {

class ActiveSystem {
 public:
  using Sparse = Eigen::SparseMatrix<double>;

  ActiveSystem();
  ~ActiveSystem();
  ActiveSystem(ActiveSystem&&) noexcept;
  ActiveSystem& operator=(ActiveSystem&&) noexcept;

  void factorize(const Matrix& A, const Sparse& E, const Sparse& P, const Eigen::VectorXd& D);

  bool singular() const { return singular_; }
  double reciprocal_condition() const { return rcond_; }  // 1-norm, estimated, of the scaled matrix

  /// r ← B⁺ r, and B⁺ᵀ r. Returns the part of r that no y reaches: ‖r − B y‖∞ / ‖r‖∞, scaled; 0 where B is regular.
  double solve(Eigen::VectorXd& r) const;
  double solve_transposed(Eigen::VectorXd& r) const;

 private:
  struct Factors;
  void form(const Matrix& A, const Sparse& E, const Sparse& P, const Eigen::VectorXd& D);
  void factorize_regular(bool definite);
  void factorize_singular(bool monotone, double noise);
  bool scale_rows_and_columns();                                  // true: symmetric, with a positive diagonal
  void apply_inverse(Eigen::VectorXd& x, bool transposed) const;  // regular
  double least_norm(Eigen::VectorXd& x, bool transposed) const;
  double estimate_condition() const;
  double solve_as(Eigen::VectorXd& r, bool transposed) const;

  Index unknowns_ = 0, extra_ = 0;  // y, and the u before it
  bool dense_ = true, singular_ = false;
  bool monotone_ = false;  // the factors are those of B + δ I
  double rcond_ = 1;
  Eigen::MatrixXd full_;          // scaled
  Sparse rows_;                   // scaled
  Eigen::VectorXd row_, column_;  // 1 / scale
  std::unique_ptr<Factors> factors_;
};

}  // namespace orthant

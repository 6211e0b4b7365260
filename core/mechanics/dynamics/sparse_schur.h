// core/mechanics/dynamics/sparse_schur.h — Schur complement of many joint rows, S = G M⁻¹ Gᵀ = L Lᵀ, sparse.
//
//   M x − Gᵀ λ = f,  G x = c:   S λ = c − G M⁻¹ f,  x = M⁻¹ (f + Gᵀ λ)
// M is diagonal, so S is as sparse as the bodies that rows have in common. Of a net of 10⁴ bars, factors of S have
// a hundredth of the entries that LU factors of the saddle matrix have, whose zeros on the diagonal move its pivots.
//
// Of dependent rows, and of nearly dependent ones as of a long cantilever, S + 1e-8 diag S is factorized. Its factors
// precondition the method of conjugate residuals for S λ = c − G M⁻¹ f, begun at λ = 0: so λ is the one of least
// Σ S_ii λ_i² (copies of a joint share its force). Where c contradicts itself, x makes Σ (c − G x)_i² / S_ii least, and
// λ errs by as much as c does. Eigenvalues far above 1e-8 take four rounds together, each one below about one more.
// Source: Saad, Iterative Methods for Sparse Linear Systems, 2nd ed. (2003), 6.8 and 9.2.
#pragma once

#include <orthant/core/mechanics/rows.h>
#include <orthant/core/support/cholmod_factor.h>

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

namespace orthant {

template <class Space> class SparseSchurOf {
 public:
  using Row = RowOf<Space>;

  /// `rows` states which two bodies each row acts on. These stay the same in all factorizations. Null where S would be
  /// far from sparse, as of many joints of one body.
  static std::unique_ptr<SparseSchurOf> of(std::span<const Row> rows, int bodies);

  /// False: S is not positive definite, or not finite, or the least pivot is at most `dependent` times its S_ii.
  bool factorize(std::span<const Row> G, const Eigen::VectorXd& inverse_mass, double dependent);

  /// After a factorize() that was false: the same rows as dependent ones. False: not finite.
  bool factorize_dependent();

  /// Shapes: f, x: all velocities; c, lambda: rows. x may be f, and lambda may be c. All NaN: no solution was found.
  void solve(const double* f, const double* c, double* x, double* lambda);

  /// The least pivot of the last factorization over its S_ii, in (0, 1]; of dependent rows, of the independent ones.
  double independence() const { return independence_; }
  /// Of the last factorization; of dependent rows as many as have a pivot that the shift alone does not explain.
  int rank() const { return rank_; }

 private:
  SparseSchurOf(std::vector<int> start, std::vector<int> index);
  SymmetricColumns columns() const { return {start_, index_, value_}; }
  bool two_rounds(double* lambda);
  bool conjugate_residuals(double* lambda);
  bool forget_contradiction(double* lambda);
  void set_missing();
  void set_force(const std::vector<double>& rows, Eigen::VectorXd& force) const;

  std::vector<int> start_, index_;                // of the upper triangle of S, by columns
  std::vector<double> value_, diagonal_, share_;  // S with what is added to it; S_ii; of each pivot
  CholmodFactor factor_;
  bool dependent_ = false;
  int rank_ = 0;
  double independence_ = 0;
  std::vector<Row> G_;  // as factorized last
  Eigen::VectorXd inverse_mass_, x_;
  std::vector<double> wanted_, missing_;  // c; c − G x
  std::vector<std::size_t> blank_;        // of dependent rows those without entries
  // Of conjugate residuals: the missing preconditioned, the direction, S times the direction, and that preconditioned.
  std::vector<double> residual_, direction_, image_, answer_;
  Eigen::VectorXd residual_force_, direction_force_, velocity_;  // Gᵀ residual, Gᵀ direction, M⁻¹ of either
};
extern template class SparseSchurOf<Planar>;
extern template class SparseSchurOf<Spatial>;

}  // namespace orthant

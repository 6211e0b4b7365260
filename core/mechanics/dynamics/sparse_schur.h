// core/mechanics/dynamics/sparse_schur.h — Schur complement of many joint rows, S = G M⁻¹ Gᵀ = L Lᵀ, sparse.
//
//   M x − Gᵀ λ = f,  G x = c:   S λ = c − G M⁻¹ f,  x = M⁻¹ (f + Gᵀ λ)
// M is diagonal, so S is as sparse as the bodies that rows have in common. Of a net of 10⁴ bars, factors of S have
// a hundredth of the entries that LU factors of the saddle matrix have, whose zeros on the diagonal move its pivots.
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

  /// Shapes: f, x: all velocities; c, lambda: rows. x may be f, and lambda may be c.
  void solve(const double* f, const double* c, double* x, double* lambda);

  /// The least pivot of the last factorization over its S_ii, in (0, 1].
  double independence() const { return independence_; }

 private:
  SparseSchurOf(std::vector<int> start, std::vector<int> index);
  SymmetricColumns columns() const { return {start_, index_, value_}; }

  std::vector<int> start_, index_;  // of the upper triangle of S, by columns
  std::vector<double> value_, diagonal_, wanted_, missing_;
  CholmodFactor factor_;
  double independence_ = 0;
  std::vector<Row> G_;  // as factorized last
  Eigen::VectorXd inverse_mass_, x_;
};
extern template class SparseSchurOf<Planar>;
extern template class SparseSchurOf<Spatial>;

}  // namespace orthant

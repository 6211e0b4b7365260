// core/mechanics/dynamics/basic_system.h — saddle-point system of the mechanism without contact: factorized once.
//
//   M̂ x − Gᵀ λ = f,   G x = c,      M̂ = M + Σ_springs row ⊗ row (k_weight k + c_weight c)
// This is the DAE's matrix without contact and friction; contacts enter through its inverse. Four ways, by the content
// of the scene:
//   M̂ = M, no joints         x = M⁻¹ f
//   M̂ = M, few joint rows    S = G M⁻¹ Gᵀ, dense (schur.h)
//   M̂ = M, many joint rows   S, sparse, by CHOLMOD (sparse_schur.h), where it is sparse
//   anything else            the sparse saddle matrix by KLU (SuiteSparse), symbolic analysis once a topology
// Redundant joints make S singular. x is unique all the same, and of the many λ that of least Σ S_ii λ_i² is taken
// (copies of a joint share its force; no unit matters), by orthogonal decomposition of L⁻¹ Gᵀ, M̂ = L Lᵀ: not of S,
// whose condition is the square. Rows that are independent only by drift below 3e-7 of their length count as redundant.
// A sparse S of more than 256 rows is solved by conjugate residuals instead (sparse_schur.h). A saddle matrix with
// springs and more than 1000 joint rows is decomposed only where its factors do not keep G x = c.
// Source: Brogliato & Acary, Numerical Methods for Nonsmooth Dynamical Systems (2008), ch. 10; Davis, KLU (2010).
#pragma once

#include <orthant/core/mechanics/dynamics/schur.h>
#include <orthant/core/mechanics/dynamics/sparse_schur.h>
#include <orthant/core/mechanics/dynamics/terms.h>

#include <Eigen/Dense>
#include <memory>
#include <optional>

namespace orthant {

template <class Space> class BasicSystemOf {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;
  using Row = RowOf<Space>;
  /// `with_joints` false leaves G out, so that the joints can stand in the complementarity problem instead.
  explicit BasicSystemOf(const System& system, bool with_joints = true);
  ~BasicSystemOf();
  BasicSystemOf(BasicSystemOf&&) noexcept;

  /// Reads terms.G and terms.springs. `added`: to M's diagonal (dof), ≥ 0; null: nothing. False: not finite, nothing
  /// usable.
  bool factorize(const System& system, const Terms& terms, double stiffness_weight = 0, double damping_weight = 0,
                 const Eigen::VectorXd* added = nullptr);

  /// f has dof entries, c joint_rows() entries; λ likewise (both empty without joints). Sizes are not checked.
  void solve(const double* f, const double* c, double* x, double* lambda) const;

  /// G (v + x) = c: x, the change of velocities v. `G`: the rows that were factorized.
  void solve_change(std::span<const Row> G, const double* f, const double* v, const double* c, double* x,
                    double* lambda) const;

  /// Adds to x the solution for f = 0.
  void add_rates(const double* c, double* x) const;

  /// Right-hand side f = rowᵀ, c = 0.
  void solve_row(const Row& row, double* x) const;

  /// The next factorization chooses its pivots again, as the first one does: its result depends on no matrix before.
  void forget();

  int joint_rows() const { return rows_; }
  /// Of M with what was added in the last factorization.
  const Eigen::VectorXd& inverse_mass() const { return inverse_mass_; }
  bool redundant() const { return redundant_; }  // the last factorization met dependent joint rows
  /// Of the joint rows, as the last factorization found it; an estimate where a sparse S of many rows is singular.
  int rank() const;
  /// Independence of the most dependent of rank() joint rows in the last factorization: the square of its remainder
  /// over its S_ii, in (0, 1]. It is near 0 next to a singular pose, and 1 where there are no joints. For the saddle
  /// matrix it is computed on request, at the cost of another factorization.
  double independence() const;

 private:
  struct Sparse;     // KLU and the pattern
  struct LeastNorm;  // for redundant joints
  enum class Method { diagonal, dense, cholesky, saddle, least_norm };

  int dof_ = 0, rows_ = 0;
  bool redundant_ = false, added_ = false;
  Method method_ = Method::diagonal;  // of the last factorization
  Eigen::VectorXd inverse_mass_;
  std::optional<SchurOf<Space>> schur_;
  std::unique_ptr<SparseSchurOf<Space>> sparse_schur_;
  std::unique_ptr<LeastNorm> least_norm_;
  std::unique_ptr<Sparse> sparse_;
  Eigen::VectorXd zero_;  // as many as there are joint rows, or coordinates
  mutable Eigen::VectorXd force_, lambda_;
};
extern template class BasicSystemOf<Planar>;
extern template class BasicSystemOf<Spatial>;
using BasicSystem = BasicSystemOf<Planar>;

}  // namespace orthant

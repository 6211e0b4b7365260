// core/mechanics/basic_system.h — the saddle system of the mechanism without contact, factorized once and solved often.
//
//   M̂ x − Gᵀ λ = f,   G x = c,      M̂ = M + Σ_springs row ⊗ row (k_weight k + c_weight c)
// This is the DAE's matrix that is left when contact and friction are removed; contacts enter through its inverse.
// Three ways, by what the scene contains:
//   no joints, no springs   x = M⁻¹ f
//   few joint rows, no springs  S = G M⁻¹ Gᵀ by dense Cholesky
//   anything else           the sparse saddle matrix by KLU (SuiteSparse), symbolic analysis once a topology
// Redundant joints make S singular. x is unique all the same, and of the many λ that of least Σ S_ii λ_i² is taken (copies
// of a joint share its force; no unit matters), by orthogonal decomposition of L⁻¹ Gᵀ, M̂ = L Lᵀ: not of S, whose
// condition is the square. Rows that are independent only by drift below 3e-7 of their length count as redundant.
// Source: Brogliato & Acary, Numerical Methods for Nonsmooth Dynamical Systems (2008), ch. 10; Davis, KLU (2010).
#pragma once

#include <orthant/core/mechanics/terms.h>

#include <Eigen/Dense>
#include <memory>

namespace orthant {

class BasicSystem {
 public:
  /// `with_joints` false leaves G out, so that the joints can stand in the complementarity problem instead.
  explicit BasicSystem(const System& system, bool with_joints = true);
  ~BasicSystem();
  BasicSystem(BasicSystem&&) noexcept;

  /// Reads terms.G and terms.springs. False: not finite, nothing usable.
  bool factorize(const System& system, const Terms& terms, double stiffness_weight = 0, double damping_weight = 0);

  /// f has dof entries, c joint_rows() entries; λ likewise (both empty without joints). Sizes are not checked.
  void solve(const double* f, const double* c, double* x, double* lambda) const;

  /// Right-hand side f = rowᵀ, c = 0.
  void solve_row(const Row& row, double* x) const;

  int joint_rows() const { return rows_; }
  bool redundant() const { return redundant_; }  // the last factorization met dependent joint rows
  /// What is left of the most dependent joint row of the last factorization, squared over its S_ii, in (0, 1]: near 0 next
  /// to a singular pose. 1 where it is not known (redundant rows, the sparse matrix).
  double independence() const { return independence_; }

 private:
  struct Sparse;     // KLU and the pattern
  struct LeastNorm;  // for redundant joints
  struct Shared {    // rows i ≥ j meet in a body, as side (0: a, 1: b) of each
    int i, j, side_i, side_j, body;
  };
  bool factorize_dense(const Terms& terms);
  bool find_least_norm(bool finite);
  void multiply_G(const double* x, double* y) const;

  int dof_ = 0, rows_ = 0;
  bool redundant_ = false;
  double independence_ = 1;
  Eigen::VectorXd inverse_mass_;
  std::vector<Row> G_;  // those of the last factorization
  std::vector<Shared> shared_;
  Eigen::MatrixXd S_;  // below and on the diagonal its Cholesky factor
  std::unique_ptr<LeastNorm> least_norm_;
  std::unique_ptr<Sparse> sparse_;
  mutable Eigen::VectorXd y_, f_, force_, zero_, lambda_;
};

}  // namespace orthant

// solvers/derivatives/sensitivity.h — derivatives of a solution with respect to the data.
//
//   z(A, b, lo, hi, μ) solves the problem; w = A z + b. With ẇ₀ = Ȧ z + ḃ, the change of w at a fixed z, the active
//   pattern (active_pattern.h: E, P, D, p) gives
//     tangent   B y = −Pᵀ (ẇ₀ + A p),   B = Pᵀ A E + D,   ż = p + E y,   ẇ = A ż + ẇ₀                            (1)
//     adjoint   of gᵀ ż + hᵀ ẇ:  a = g + Aᵀ h,  Bᵀ λ = Eᵀ a;  with respect to b: h − P λ =: β, to A: β zᵀ,
//               to bounds and μ: through p, πᵀ p with π = a − Aᵀ P λ                                             (2)
//   B is factorized once (active_system.h), each product costs one solve.
//   Weakly active rows (w = 0 at a bound): z has one-sided derivatives only. jvp() and vjp() hold these rows at their
//   bounds: one of the limits of nearby derivatives. directional() solves for their sides: u of
//     0 ≤ u ⊥ S u + s ≥ 0,   S = P_Dᵀ A (E_D − E B⁻¹ Pᵀ A E_D),  s = P_Dᵀ ẇ of (1)                                (3)
//   (with Coulomb's law where a contact without force or slip has friction), positively homogeneous in the data.
//   Redundant rows (B singular, as of contacts that hold a body more than once): z is not unique. Given is the ż of
//   least norm of the scaled system; only what all solutions share, ẇ or the velocities M⁻¹ Wᵀ ż, is a derivative. It
//   exists for changes that keep the redundancy (`consistent`). Discs that slide on redundant contacts share their load
//   as the given z does: there the motion itself may depend on that choice.
//   A contact that is open and has no slip keeps z_T = 0, and bounds that coincide move together: changes against this
//   have one-sided derivatives, which are not given.
//   Sources: Robinson, Math. Oper. Res. 5 (1980) 43-62; Facchinei & Pang, Finite-Dimensional Variational Inequalities
//   and Complementarity Problems (2003), ch. 5.
#pragma once

#include <orthant/solvers/derivatives/active_pattern.h>
#include <orthant/solvers/derivatives/active_system.h>

#include <optional>
#include <string>

namespace orthant {

/// Changes of the data: an empty part does not change.
struct Perturbation {
  /// Ȧ. For a Delassus operator in a Delassus operator: the changes of its parts W, M⁻¹ and R, an empty one is 0.
  std::optional<Matrix> A;
  Vector b, lo, hi;  // n
  Vector mu;         // one a friction
};

struct SolutionTangent {
  Vector z, w;             // n
  bool consistent = true;  // false: the redundant rows part, and there is no derivative
  double parted = 0;  // of ẇ at fixed z, relative to its largest: what no change of z undoes; consistent: ≤ 1e-6
};

/// Of a scalar with respect to the data. With respect to A_ij it is b_i z_j: gradient_of_matrix().
struct DataGradient {
  Vector b, lo, hi, mu;
  bool consistent = true;  // false: the scalar depends on the choice among solutions, and has no derivative
  double parted = 0;       // of the scalar's gradient by z, relative to its largest: what depends on the choice
};

struct SensitivityReport {
  Index unknowns = 0;               // of the linear system
  double reciprocal_condition = 1;  // of its scaled matrix, estimated
  bool redundant = false;           // the matrix is singular: derivatives of what is unique only
  std::vector<WeaklyActive> weakly_active;
  double threshold = 0;  // [units of w] below which a row counts as weakly active
  Vector margin;         // n [units of w]: how far each row is from another pattern
  Index nearest = -1;    // the row with the least margin that is not weakly active; −1: none
  bool differentiable() const { return weakly_active.empty(); }
};

/// In a few lines.
std::string words_of(const SensitivityReport& report);

class Sensitivity {
 public:
  /// `solution` has an answer (solved or rounded) for the problem, else std::invalid_argument. Both are copied.
  Sensitivity(const Lcp& problem, const Solution& solution);

  const SensitivityReport& report() const { return report_; }

  /// (1). Parts of other sizes than the problem's throw std::invalid_argument.
  SolutionTangent jvp(const Perturbation& change) const;
  /// (2) of gᵀ ż + hᵀ ẇ; an empty h is 0.
  DataGradient vjp(const Vector& g, const Vector& h = {}) const;
  /// (3): the one-sided derivative along the change. Throws std::runtime_error where (3) is not solved.
  SolutionTangent directional(const Perturbation& change) const;

  const Lcp& problem() const { return problem_; }
  const Vector& z() const { return z_; }

 private:
  SolutionTangent tangent(const Perturbation& change, Eigen::VectorXd& at_rest) const;
  Eigen::VectorXd transposed(const Eigen::VectorXd& x) const;  // Aᵀ x
  Vector times(const Vector& x) const;                         // A x

  Lcp problem_;
  Vector z_;
  ActivePattern pattern_;
  ActiveSystem system_;
  SensitivityReport report_;
};

inline Sensitivity sensitivity(const Lcp& problem, const Solution& solution) { return {problem, solution}; }

/// ∂/∂A of the gradient's scalar, stored as A: dense, on the pattern of a sparse A, or the parts of an operator.
Matrix gradient_of_matrix(const Sensitivity& of, const DataGradient& gradient);

/// Ȧ x for a change of A as Perturbation has it.
Vector multiply_change(const Matrix& A, const Matrix& change, const Vector& x);

}  // namespace orthant

// solvers/cones/cone_admm.h — admm on friction discs: operator splitting, De Saxcé's term updated every iteration.
//
//     x ← (A + (η + ρ) I)⁻¹ (−q − s + η x + ρ y + λ),   y ← P_K(x − λ/ρ),   λ ← λ + ρ (y − x),
//     s = e_n Σ μ_j ‖λ_{T_j}‖  (λ tends to û: −q − A x − s + λ = 0)
//   in scaled numbers, η = 1e-8. One factorization a penalty ρ. A = S + N, S symmetric: where ‖N‖_∞ ≤ 0.02, S is
//   factorized (CHOLMOD) and N x taken from the last iteration, a third to a tenth of the time of an LU factorization;
//   else LU (cone_system.h). Where N is rounding only (1e-10), N x is found every 20 iterations. Of an operator with
//   fewer coordinates than rows (bodies with many contacts) the factors are those of the coordinates
//   (shifted_operator.h). ρ is multiplied or divided where the residuals ‖x − y‖, ρ ‖y − y_old‖ differ by more than
//   ten; looked at every 20 iterations.
//   Converges for μ = 0 and A symmetric semidefinite; in practice mostly, to moderate accuracy. A may be unsymmetric.
//   Source: Carpentier, Le Lidec & Montaut, From compliant to rigid contact simulation (2024); Boyd et al. (2011).
#pragma once

#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/cone_system.h>
#include <orthant/solvers/linear_algebra/shifted_operator.h>

namespace orthant {

/// The iteration by itself, for solvers that put several together.
class ConeSplitting {
 public:
  /// Both must outlive the steps.
  void load(const ConeForm& form, const Budget* budget);
  /// λ = û(A z + q), or 0 where z is.
  void start(const Vector& z, double rho);
  /// One iteration; false where no factors are to be had, or numbers ran away. `adapt`: ρ is looked at.
  bool step(bool adapt = true);
  const Vector& z() const { return y_; }
  double rho() const { return rho_; }

 private:
  void load_symmetric();
  void load_system();
  bool factorize();
  bool solve();  // x_ ← (A + (η + ρ) I)⁻¹ rhs_

  struct Entry {
    int row, column;
    double value;
  };
  const ConeForm* form_ = nullptr;
  const Budget* budget_ = nullptr;
  enum class Factors { coordinates, rows, unsymmetric };
  Factors factors_ = Factors::rows;
  ConeSystem system_;  // unsymmetric
  ShiftedOperator operator_;
  SparseCholesky cholesky_;
  RowSparse S_;
  std::vector<int> diagonal_;  // of S_, places
  std::vector<Entry> N_;       // above the diagonal
  double skew_ = 0;            // ‖N‖_∞
  bool factorized_ = false;
  double shift_ = 0;  // on the diagonal of S_
  double rho_ = 0.1, primal_ = 0, dual_ = 0;
  int steps_ = 0;
  Vector x_, y_, lambda_, before_, rhs_, Nx_;
};

class ConeAdmm final : public ConeSolver {
 public:
  struct Options {
    double tolerance = 1e-10, rho = 1;
    int max_iterations = 20000;
    bool adapt = true;
  };
  explicit ConeAdmm(const Options& options) : options_(options) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  ConeSplitting splitting_;
};

}  // namespace orthant

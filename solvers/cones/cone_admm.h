// solvers/cones/cone_admm.h — admm on friction discs: operator splitting, De Saxcé's term updated every iteration.
//
//     x ← (A + (η + ρ) I)⁻¹ (−q − s + η x + ρ y + λ),   y ← P_K(x − λ/ρ),   λ ← λ + ρ (y − x),
//     s = e_n Σ μ_j ‖λ_{T_j}‖  (λ tends to û: −q − A x − s + λ = 0)
//   in scaled numbers, η = 1e-8. One factorization a penalty ρ: dense up to 240 rows, else UMFPACK. ρ is multiplied or
//   divided where the two residuals ‖x − y‖, ρ ‖y − y_old‖ differ by more than ten.
//   Converges for μ = 0 and A symmetric semidefinite; in practice mostly, to moderate accuracy. A may be unsymmetric.
//   Source: Carpentier, Le Lidec & Montaut, From compliant to rigid contact simulation (2024); Boyd et al. (2011).
#pragma once

#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/cone_system.h>

namespace orthant {

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
  ConeSystem system_;
  Vector x_, lambda_, before_, s_;
};

}  // namespace orthant

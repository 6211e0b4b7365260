// solvers/first_order/admm.h — ADMM: alternating directions (Douglas-Rachford) between w = A z + b and the bounds.
//
//   Find z in [lo, hi] with −(A z + b) in the normal cone at z; y stands for −w. With S = ρ D, D the diagonal of A:
//     x ← (A + S)⁻¹ (S z − y − b),   x ← α x + (1 − α) z,   z ← clamp(x + S⁻¹ y, lo, hi),   y ← y + S (x − z).
//   Converges for every A with xᵀA x ≥ 0, unsymmetric, singular or with zeros on its diagonal (saddle points), any ρ >
//   0, 0 < α < 2, wherever there is a solution. Free rows take 10⁻³ ρ (they have no bound), fixed ones 10³ ρ.
//   The rate depends on ρ: at iterations 10, 15, 22, … ρ is multiplied by √(primal / dual residual), both relative,
//   where that is more than 5 or less than 1/5; the factors serve until then.
//     dense, sparse   A + S: Cholesky when A is symmetric, else LU (principal_block.h); two O(n²) or sparse solves
//     Delassus        never formed: (S' + B Bᵀ)⁻¹ with B = W M^-½, S' = S + R through the sparse I + BᵀS'⁻¹B, m × m
//   One solve and one product an iteration. To 1e-3 in tens of iterations, further slowly: linear at best.
//   Friction rows hold their bounds while boxes are solved (first_order.h): in practice. A_ii < 0 → unsupported.
//   A + S singular → stalled.  The start value is used, its w as −y.  Ends: first_order.h.
//   Sources: Stellato, Banjac, Goulart, Bemporad & Boyd, Math. Prog. Comp. 12 (2020) 637-672 (OSQP); Lions & Mercier,
//   SIAM J. Numer. Anal. 16 (1979) 964-979.
#pragma once

#include <orthant/solvers/first_order/first_order.h>
#include <orthant/solvers/linear_algebra/principal_block.h>

#include <vector>

namespace orthant {

struct AdmmOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_iterations = 20000;
  double rho = 0.1;    // ρ at the start
  bool adapt = true;   // false: ρ stays
  double alpha = 1.6;  // relaxation α
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000000);
    v("rho", rho, 1e-6, 1e6), v("adapt", adapt), v("alpha", alpha, 0.1, 1.95);
  }
};

class Admm final : public FirstOrder {
 public:
  using Options = AdmmOptions;
  explicit Admm(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override { return detail::diagonal_why_not(problem.A, true); }

 private:
  void load(const Lcp& problem, Vector& z) override;
  Step advance(const Lcp& problem, Vector& z) override;
  void factorize(const Lcp& problem);
  void solve(const Lcp& problem);  // x ← (A + S)⁻¹ x
  bool adapt(const Lcp& problem, const Vector& z);
  int max_iterations() const override { return options_.max_iterations; }
  double tolerance() const override { return options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp

  Options options_;
  detail::HeldBounds bounds_;
  Matrix shifted_;  // A + S, or I + BᵀS'⁻¹B
  PrincipalBlock factors_;
  std::vector<Index> all_;
  Vector s_, x_, y_, w_, before_, r_, t_, scratch_;
  double rho_ = 1;
  int iteration_ = 0, next_look_ = 0;
  bool regular_ = false;
};

}  // namespace orthant

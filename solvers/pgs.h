// solvers/pgs.h — projected Gauss–Seidel.
//
//   Find z within its bounds, w = A z + b:  z = lo ⇒ w ≥ 0,  z = hi ⇒ w ≤ 0,  otherwise w = 0, row by row.
//   Sweep i = 1..n:  z_i ← clamp(z_i − ω w_i / A_ii, lo_i, hi_i),  w_i from the newest z.   O(nnz) a sweep.
//   A friction row's bounds are ∓μ z_n at the newest z_n; an equality row has none.
//   On Delassus storage A is never formed: u = M⁻¹ Wᵀ z is kept up to date, w_i = W_i u + R_i z_i + b_i.
//   A n×n [1/kg], A_ii > 0;  b, w n [m/s];  z n [N s].  Converges for A symmetric positive definite without friction
//   rows, 0 < ω < 2; with friction in practice. The start value is used.
//   A_ii ≤ 0 → unsupported (why_not names the row).  Sweeps used up → iteration_limit;  changes that no longer reach the
//   rounding of z while the judge still rejects → stalled.  The last z is kept.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 5; Jean, CMAME 177 (1999) 235-257.
#pragma once

#include <orthant/solvers/solver.h>

#include <vector>

namespace orthant {

struct PgsOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_sweeps = 100000;
  double omega = 1.0;  // relaxation ω
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_sweeps", max_sweeps, 1, 1000000000), v("omega", omega, 1e-3, 1.999);
  }
};

class Pgs final : public Solver {
 public:
  using Options = PgsOptions;
  explicit Pgs(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Status run(const Lcp& problem, Solution& s, Start start) override;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Status& claim) override;
  double tolerance() const override { return options_.tolerance; }
  Status sweep(const Lcp& problem, Solution& s);

  Options options_;
  double target_ = 0;  // largest change of a sweep, in units of w, at which the judge is asked
  mutable Vector diag_;
  Vector u_;
  std::vector<Index> friction_of_;  // per row: its entry of problem.friction, or −1
};

}  // namespace orthant

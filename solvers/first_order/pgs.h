// solvers/first_order/pgs.h — projected Gauss-Seidel (PGS); stopping criterion: first_order.h.
//
//   Find z within its bounds, w = A z + b:  z = lo ⇒ w ≥ 0,  z = hi ⇒ w ≤ 0,  otherwise w = 0, row by row.
//   Sweep i = 1..n:  z_i ← clamp(z_i − ω w_i / A_ii, lo_i, hi_i),  w_i from the newest z (sweeps.h).   O(nnz) a sweep.
//   A friction row's bounds are ∓μ z_n at the newest z_n; an equality row has none. A Delassus operator is never
//   formed.
//   A n×n [1/kg], A_ii > 0;  b, w n [m/s];  z n [N s].  Converges for A symmetric positive definite (semidefinite,
//   where there is a solution) without friction rows, 0 < ω < 2; for H₊-matrices with ω ≤ 1; with friction in practice.
//   Near a solution the error falls by the spectral radius of the iteration on the rows between their bounds: r / (1 +
//   r) for a block of mass r m on one of m, cos²(π/2n) in a column of n equal ones. The start value is used.
//   A_ii ≤ 0 → unsupported (why_not names the row).  Ends: first_order.h.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 5; Jean, CMAME 177 (1999) 235-257.
#pragma once

#include <orthant/solvers/first_order/sweeps.h>

namespace orthant {

struct PgsOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_sweeps = 100000;
  double omega = 1.0;  // relaxation ω
  int threads = 1;     // of sweeps over many friction discs (cones/operator_sweeps.h); no result depends on it
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_sweeps", max_sweeps, 1, 1000000000), v("omega", omega, 1e-3, 1.999);
    v("threads", threads, 1, 1024);
  }
};

class Pgs final : public SweepSolver {
 public:
  using Options = PgsOptions;
  explicit Pgs(const Options& options = {}) : options_(options) {}

 private:
  Step advance(const Lcp&, Vector& z) override { return step(sweeps_.sweep(z, options_.omega)); }
  int max_iterations() const override { return options_.max_sweeps; }
  double tolerance() const override { return options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp
  Options options_;
};

}  // namespace orthant

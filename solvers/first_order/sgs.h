// solvers/first_order/sgs.h — symmetric projected Gauss-Seidel: a sweep forward, then one backward.
//
//   As pgs.h, rows 1..n and then n..1: an iteration is two sweeps. No row is always the last, so the error is not
//   concentrated at one end of a stack, and the iteration is symmetric: for A symmetric positive definite the
//   eigenvalues on the rows between their bounds, those of (D + U)⁻¹ L (D + L)⁻¹ U, are real and in [0, 1).
//   Cost 2 O(nnz) an iteration. On chains it converges as two sweeps of pgs do; where rows are numbered against the
//   flow of forces, better. With ω ≠ 1 this is SSOR.  Bounds, friction, storage, ends: as pgs.h.
//   Source: Young, Iterative Solution of Large Linear Systems (1971), ch. 15; Cottle, Pang & Stone (1992), ch. 5.
#pragma once

#include <orthant/solvers/first_order/pgs.h>

namespace orthant {

class Sgs final : public SweepSolver {
 public:
  using Options = PgsOptions;  // max_sweeps counts iterations: pairs of sweeps
  explicit Sgs(const Options& options = {}) : options_(options) {}

 private:
  Step advance(const Lcp&, Vector& z) override {
    return step(sweeps_.sweep(z, options_.omega) + sweeps_.sweep(z, options_.omega, Sweeps::Order::backward));
  }
  int max_iterations() const override { return options_.max_sweeps; }
  double tolerance() const override { return options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp
  Options options_;
};

}  // namespace orthant

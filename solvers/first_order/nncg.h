// solvers/first_order/nncg.h — nonsmooth nonlinear conjugate gradients over projected Gauss-Seidel sweeps.
//
//   A sweep of pgs.h is a fixed-point map G; its step r_k = G(z_k) − z_k stands for a negative gradient (for an A
//   symmetric positive definite it is one, in a metric), to which Fletcher and Reeves' recursion is applied:
//     β = ‖r_k‖² / ‖r_{k−1}‖²;   β > 1: p = r_k (restart), else  z_k+1 = G(z_k) + β p,  p ← β p + r_k
//   and the next sweep brings every row back within its bounds. Norms in the metric of the diagonal of A. An iteration
//   is a sweep and O(n), since the state of a sweep follows z along p linearly: dense, sparse and Delassus storage
//   alike.
//   On friction discs: pairs of sweeps with Nesterov's momentum (cones/cone_pgs.h), as sweeps in one direction are no
//   gradient there.
//   Superlinear in practice until the active set is found, no proof; the violation is not monotone. Bounds, friction
//   and ends as pgs.h; the z that is judged is one that a sweep has just left.
//   Source: Silcowitz-Hansen, Niebe & Erleben, The Visual Computer 26 (2010) 893-901.
#pragma once

#include <orthant/solvers/first_order/sweeps.h>

namespace orthant {

struct NncgOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_sweeps = 100000;
  int threads = 1;  // of sweeps over many friction discs (cones/operator_sweeps.h); no result depends on it
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_sweeps", max_sweeps, 1, 1000000000), v("threads", threads, 1, 1024);
  }
};

class Nncg final : public SweepSolver {
 public:
  using Options = NncgOptions;
  explicit Nncg(const Options& options = {}) : options_(options) {}

 private:
  void load(const Lcp& problem, Vector& z) override;
  Step advance(const Lcp& problem, Vector& z) override;
  int max_iterations() const override { return options_.max_sweeps; }
  double tolerance() const override { return options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp

  Options options_;
  Vector p_, p_state_, r_, r_state_;  // directions, and what they do to the state of the sweeps
  double norm_ = 0, beta_ = 0;        // ‖r‖², β: of the move that comes before the next sweep
};

}  // namespace orthant

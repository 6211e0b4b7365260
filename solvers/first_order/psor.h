// solvers/first_order/psor.h — projected successive over-relaxation that adapts ω.
//
//   The sweeps of pgs.h with ω in (0, 2). For A symmetric positive definite every ω converges (Cryer 1971), the best is
//     ω = 2 / (1 + √(1 − μ²)),   μ the spectral radius of Jacobi's iteration on the rows between their bounds
//   (exactly so for consistently ordered A: chains, grids): the number of sweeps becomes its square root.
//   omega = 0: start with ω = 1. After each 10 sweeps in which no row changed sides, λ = the mean rate of the largest
//   change; where two such rates agree and λ is above the ω − 1 of an ω past the best, (λ + ω − 1)² = λ ω² μ² gives μ,
//   and μ the next ω. Where changes then, after a first 10 / (2 − ω) sweeps, do not fall to a tenth in as many, or ω is
//   raised more than six times while they do not, A is none of these: back to ω = 1, permanently.
//   Bounds, friction, storage, cost, ends: as pgs.h.
//   Sources: Cryer, SIAM J. Control 9 (1971) 385-392; Hageman & Young, Applied Iterative Methods (1981), ch. 9.
#pragma once

#include <orthant/solvers/first_order/sweeps.h>

namespace orthant {

struct PsorOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_sweeps = 100000;
  bool stop_early = false;  // as soon as max_sweeps would not do (first_order.h)
  double omega = 0;         // relaxation ω; 0: found while running
  int threads = 1;          // of sweeps over many friction discs (cones/operator_sweeps.h); no result depends on it
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_sweeps", max_sweeps, 1, 1000000000), v("stop_early", stop_early),
        v("omega", omega, 0.0, 1.9999), v("threads", threads, 1, 1024);
  }
};

class Psor final : public SweepSolver {
 public:
  using Options = PsorOptions;
  explicit Psor(const Options& options = {}) : options_(options) {}

 private:
  void load(const Lcp& problem, Vector& z) override;
  Step advance(const Lcp& problem, Vector& z) override;
  void adapt(const Sweeps::Change& change);
  int max_iterations() const override { return options_.max_sweeps; }
  int first_look_ahead() const override { return options_.stop_early ? 64 : 0; }
  double tolerance() const override { return options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp

  Options options_;
  bool adaptive_ = true;
  double omega_ = 1, first_ = 0, rate_ = 0;  // largest change where the present 10 sweeps began; rate of the 10 before
  int sweeps_done_ = 0;                      // of the present 10
  double promised_ = 0;                      // largest change, `since_` sweeps ago, that ω > 1 is to make a tenth of
  int since_ = 0, raises_ = 0;
  double raised_at_ = 0;  // largest change at the first of the raises
};

}  // namespace orthant

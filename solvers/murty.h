// solvers/murty.h — principal pivoting by the least index: the first row with a wrong sign changes sides.
//
//   Find z in [lo, hi], w = A z + b, by a choice of side for each row (active_rows.h), starting from lower (or upper)
//   bounds. Each iteration solves for the present choice and moves the row of least index whose sign is wrong.
//   Finite for P-matrices and any b; up to 2ⁿ − 1 moves. Degenerate rows (z_i = w_i = 0) never move, so it cannot cycle.
//   One factorization an iteration, O(|F|³) dense: a method to check others by, not to be fast.
//   Friction rows → unsupported.  A singular block → stalled.  The start value is not used.
//   Source: Murty, Opsearch 11 (1974); Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 4.2.
#pragma once

#include <orthant/solvers/active_rows.h>
#include <orthant/solvers/solver.h>

namespace orthant {

struct MurtyOptions {
  double tolerance = 1e-12;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_pivots = 100000;
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_pivots", max_pivots, 1, 1000000000);
  }
};

class Murty final : public Solver {
 public:
  using Options = MurtyOptions;
  explicit Murty(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Status run(const Lcp& problem, Solution& s, Start start) override;
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  ActiveRows rows_;
};

}  // namespace orthant

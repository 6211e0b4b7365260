// solvers/pivoting/murty.h — Murty's method: principal pivoting by the least index; the first wrong row changes sides.
//
//   Find z in [lo, hi], w = A z + b: all rows start on a bound (free rows with w = 0); the row of least index with a
//   wrong sign moves, from a bound to w = 0 or from w = 0 to the bound it broke: a principal pivot
//   (principal_tableau.h).
//   Finite for P-matrices and any b; up to 2ⁿ − 1 moves. Degenerate rows (z_i = w_i = 0) never move, so it cannot
//   cycle.
//   O(n²) a pivot, after O(n³) where there are free rows; the final z is refined as in lemke.h: a reference for other
//   methods, not a fast one. A rejected z is computed again in long double and, up to 100 rows, 256 bits.
//   Friction rows, more than 10000 rows → unsupported.  A pivot of the wrong sign or 0 (no P-matrix) → stalled.
//   The start value is not used.
//   Source: Murty, Opsearch 11 (1974); Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 4.2.
#pragma once

#include <orthant/solvers/pivoting/principal_pivoting.h>
#include <orthant/solvers/solver.h>

namespace orthant {

struct MurtyOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
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
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) override;
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 1e-12; }  // a right basis, refined, is at rounding level
  Claim attempt(int precision, Solution& s);
  template <class T> Claim method(detail::PrincipalTableau<T>& t);

  Options options_;
  detail::PrincipalPivoting pivoting_;
};

}  // namespace orthant

// solvers/pivoting/dantzig.h — Dantzig-Cottle method: principal pivoting with a driving variable.
// Source: Dantzig & Cottle; Keller; van de Panne & Whinston.
//
//   Wrong rows are corrected one after the other. Of the least row r whose w_r has a wrong sign, the driving variable
//   (z_r, or w_r where z_r is basic) is moved, and all basic variables with it, until
//     w_r is 0, or z_r meets its other bound      row r is right;
//     z_i meets a bound, or a right w_i meets 0   z_i and w_i change places (a principal pivot; where T_ii = 0, pairs i
//                                                 and r do so together) and the drive goes on;
//     nothing blocks                              r is put off; all wrong rows put off: status ray.
//   Right rows stay right, so their number grows. Boxes and free rows are rows like others; friction: pure_form.h.
//   Finite for P-matrices and for xᵀA x ≥ 0, singular ones included (redundant contacts): there a ray means that no z
//   has the signs demanded, of which the ray's direction, or else farkas.h, gives the judge a proof. Elsewhere a pivot
//   of the wrong sign ends the run: stalled. Friction makes no such matrix: there it may end so although a solution
//   exists.
//   Ties: the largest entry; after n steps of length 0 in a drive the least index, which cannot cycle (Chang & Cottle).
//   Of several solutions (hyperstatic rows) the one found depends on the order of the rows.
//   O(n²) a pivot, 2ⁿ of them at worst, usually about n; the final z is refined as in lemke.h. A rejected z
//   is computed again in long double and, up to 100 rows, 256 bits.
//   A start value is not used.   A n × n, stored densely: n ≤ 10000 in pure form.
//   Sources: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 4.2-4.3; Keller, Math. Programming 4
//   (1973); Cottle & Chang, SIAM J. Matrix Anal. Appl. 13 (1992) on ties.
#pragma once

#include <orthant/solvers/solver.h>

#include <memory>

namespace orthant {

struct DantzigOptions {
  double tolerance = 1e-10;  // accepted residual relative to ‖b‖∞; rounding level is accepted in any case
  int max_pivots = 0;        // 0: 20000 + 100 n
  bool rescue = true;        // more digits for a rejected z
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_pivots", max_pivots, 0, 1000000000), v("rescue", rescue);
  }
};

class Dantzig final : public Solver {
 public:
  using Options = DantzigOptions;
  explicit Dantzig(const Options& options = {});
  ~Dantzig() override;
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) override;
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 1e-12; }  // a right basis, refined, is at rounding level

  Options options_;
  struct Work;  // scratch: it never changes an answer
  std::unique_ptr<Work> work_;
};

}  // namespace orthant

// solvers/automatic.h — automatic solver choice by the structure of the problem, with the next one on failure.
//
//   One look at the entries, cheaper than any solve (O(nonzeros)): size, storage, friction, free rows, symmetry, signs.
//   kSteps (automatic.cpp) lists solvers in the order in which they are tried, each with its purpose and its conditions
//   on the problem. The judge (certify.h) decides after each. After the first failure a proof of infeasibility is
//   searched for. The log has one entry per solver that was tried: the reason and the result.
//     first                a guess of the active set (small_active_set.h), before any inspection: up to
//                          1500 rows of a dense matrix, 600 of an operator, 100 with friction or in sparse storage;
//                          frictionless to 6 rows then dantzig
//     friction             symmetric from 60 rows on: psor and mprgp, both abandoned if they make no progress; to 400
//                          rows, with a start value or beyond 100 rows: path without restarts
//                          from a start value, dense, 41 to 1500 rows: prox before path
//                          without a start value, dense: newton-ac, to 200 rows lemke's tableau, prox, then psor; over
//                          loose bodies: newton-ac after psor and mprgp
//     pyramids             unsymmetric, no saddle point, a zero on the diagonal, 13 to 400 rows: 250 pivots of dantzig,
//                          not the guess; then, as for games, lemke's revised form
//     sparse, unsymmetric  from 100 rows on, positive diagonal: 400 sweeps of psor, abandoned if they make no progress;
//                          to 400 rows lemke's revised form
//     nonnegative, dense   unsymmetric, positive diagonal: a hundred sweeps of psor, not the guess
//     small                lemke's tableau, refined; at last with its rescue (more digits, rationals, every basis);
//                          to 4 rows every cell after the tableau; sparse symmetric first block-pivot from 100 rows on
//     obstacles (sparse Z) psor on grids to 400 rows, multigrid, 10 iterations of block-pivot, newton-min
//     large, frictionless  dense to 1500 rows: the tableau; block-pivot where symmetric with A_ii > 0, 50 iterations
//                          or, sparse, 10; interior-point
//     large, sparse, unsymmetric   those sweeps, path without restarts, then as the others
//     large, friction      path without restarts, then sweeps (nncg)
//     else                 path; first-order methods where nothing else will hold the matrix
//     up to 2²⁰ cells      at last every cell (enumerate.h): a solution, or the proof that there is none
//   With a time limit each step may take half of the remaining time, the last all of it. No step is begun whose share
//   is less than the last step's delay at its limit.
//   A start value is passed on, and a tolerance other than the default. Guarantees: those of the solver that answered.
#pragma once

#include <orthant/solvers/solver.h>

#include <memory>
#include <vector>

namespace orthant {

struct AutomaticOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  template <class V> void visit(V&& v) { v("tolerance", tolerance, 0.0, 1.0); }
};

class Automatic final : public Solver {
 public:
  using Options = AutomaticOptions;
  explicit Automatic(const Options& options = {});
  ~Automatic() override;
  std::string why_not(const Lcp&) const override { return {}; }

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) override;
  double tolerance() const override { return options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp

  Options options_;
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace orthant

// solvers/active_set/interior_point.h — interior-point method (Mehrotra), monotone; crossover to an active set.
//
//   Each finite bound k of row i has a slack s_k = σ_k (z_i − bound_k) > 0, σ = 1 below and −1 above, and a multiplier
//   l_k > 0 with w = A z + b = Σ_k σ_k l_k. Newton's method on
//     A z + b − Σ σ_k l_k = 0,   σ_k (z − bound_k) − s_k = 0,   s_k l_k = σ μ,
//   with ds and dl eliminated, is one system an iteration, solved twice:
//     (A + D) dz = …,   D_i = Σ_k l_k / s_k   (free rows: none; rows with lo = hi: left out).
//     predictor  μ target 0;  α_a the step to the boundary, μ_a the mean s l there
//     corrector  target (μ_a / μ)³ μ, less the predictor's second-order term ds dl
//   and one step length for s, z and l: with A not zero, separate steps would violate A z + b − Σ σ l = 0. The start is
//   infeasible: (A + diag) z = −b, then s and l shifted until positive. A + D may be singular on free rows, or to
//   rounding: D is kept above 1e-14 of A's entries, more where that is not enough.
//   A start that is much closer to the boundary than the solution makes steps short: no progress in 8 iterations, and
//   it begins again with slacks 1e3, 1e6, 1e9 times as large (mass ratios of 1e10 need that).
//   Where the corrector allows no step of 0.3, one with the second-order term times α_a², then one of centring alone is
//   tried.
//   Crossover: once the rows' sides stand still from one iteration to the next (the predictor gives them: ds/s + dl/l =
//   −1, and the one of s, l that vanishes is near −1), the equations w_F = 0 of the rows inside are solved by
//     z_F ← z_F − (A_FF + t D_F)⁻¹ w_F,   t D at most 1e-8 of A's entries (smaller where that is slow),
//   the proximal point iteration: where A_FF is singular, z goes to the solution nearest to the iterate in the norm of
//   D, hence inside the bounds. Rows that come out with a wrong sign change sides as long as their number falls. The
//   judge decides; the iteration continues until it accepts at rounding level (1e-13).
//   Warm: the guess's sides are tried by crossover first (one factorization when they are right); else it is not used,
//   for a point on the boundary is a poor start of an interior method.
//   Dense and sparse storage (principal_block.h; a Delassus operator is formed, as rows where few of W's rows meet):
//   Cholesky for symmetric A, else LU; one symbolic analysis for all iterations, and for all solves of a pattern.
//   Usually 5 to 20 factorizations, whatever n.  Entries that span many powers of ten are scaled by powers of 2.
//   A must be monotone, xᵀA x ≥ 0 (not checked: else it may end stalled, or solve it all the same). Where A's condition
//   is beyond 1e10 and A is also singular, the equations w_F = 0 may be missed: stalled.
//   Friction rows with μ > 0 → unsupported.  Divergent iterates: their direction is made a proof of infeasibility (A u
//   = 0 solved for on the rows that do) → ray.  No progress in 20 iterations → stalled.
//   Source: Mehrotra, SIAM J. Optim. 2 (1992) 575-601; Wright, Primal-Dual Interior-Point Methods (1997), ch. 8, 10;
//   Colombo & Gondzio, Comput. Optim. Appl. 41 (2008); Rockafellar, SIAM J. Control Optim. 14 (1976) (proximal point).
#pragma once

#include <orthant/solvers/active_set/active_rows.h>
#include <orthant/solvers/linear_algebra/principal_block.h>
#include <orthant/solvers/linear_algebra/scaling.h>
#include <orthant/solvers/solver.h>

#include <vector>

namespace orthant {

struct InteriorPointOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_iterations = 200;
  bool crossover = true;  // false: the interior iterate is the answer, accurate to about the square root of rounding
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000), v("crossover", crossover);
  }
};

class InteriorPoint final : public Solver {
 public:
  using Options = InteriorPointOptions;
  explicit InteriorPoint(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  double tolerance() const override { return options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp

  const Lcp& prepared(const Lcp& problem);
  Claim method(const Lcp& problem, Solution& s, Start start);
  void load(const Lcp& problem);
  bool start(const Lcp& problem, double farther);
  Claim iterate(const Lcp& problem, Solution& s, double farther);
  void residuals(const Lcp& problem);  // w_, r_, gap_, error_, mu_ at the iterate
  void barrier();                      // D_
  bool factorize();
  void solve_open(Vector& x);
  void direction();  // dz_, ds_, dl_ for target_
  double step_length() const;
  void guess_sides();
  bool cross(const Lcp& problem, int iteration);  // from z_, side_, D_; true: accepted at rounding level
  bool solve_inside(const Lcp& problem, const Vector* b, double most, Vector& z);
  Index correct(const Vector& z);
  bool keep(const Lcp& problem, const Vector& z);
  bool prove(const Lcp& problem, Vector& u);

  struct Bound {
    Index row;
    double sign, value;
  };
  Options options_;
  Judge judge_;
  PrincipalBlock block_;
  detail::Scaling scaling_;
  Lcp scaled_;
  std::vector<Bound> bounds_;
  std::vector<Index> open_, inside_;  // rows with lo < hi; rows with w = 0
  std::vector<Side> side_;
  Vector lo_, hi_, scale_, z_, w_, r_, gap_, s_, l_, ds_, dl_, target_, second_, lean_, dz_, rhs_, part_, shift_, D_,
      scratch_;
  Vector ray_;
  Solution trial_, best_, put_;
  AtBounds at_bounds_;
  double size_ = 0, error_ = 0, mu_ = 0;  // |b| + |A z|; natural residual relative to it; mean of s l
  double inside_error_ = 0;               // |w_F| that solve_inside() left
};

}  // namespace orthant

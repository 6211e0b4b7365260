// solvers/proof/farkas.h — Farkas proofs: search for a proof that a problem has no solution.
//
//   No z satisfies M z + q ≥ 0, z ≥ 0 exactly when some u ≥ 0 has Mᵀu ≤ 0, qᵀu < 0 (free rows: = 0, u of any sign).
//   The linear program  min cᵀz, M z + q ≥ 0, z ≥ 0  and its dual are one LCP,
//     w_z = c − Mᵀu ⊥ z,   w_u = M z + q ⊥ u,   c = 1 (0 on free rows),
//   with a skew matrix, so that Lemke's method ends on a solution (feasible) or on a ray; its u is the proof.
//   Long double up to 100 rows (the tableau is 2n × 2n, n in pure form): it detects infeasibility of the size of one
//   rounding. Beyond, and where the tableau cycles, a sparse dual simplex method (farkas_simplex.h). A build without
//   CLP has none: there the tableau takes up to 400 rows, and larger problems get no proof.
//   certify.h checks the result.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 1.2, 3.1, 4.4.
#pragma once

#include <orthant/core/lcp/pure_form.h>
#include <orthant/solvers/budget.h>
#include <orthant/solvers/linear_algebra/scaling.h>
#include <orthant/solvers/pivoting/lemke_tableau.h>

#include <functional>
#include <vector>

namespace orthant {

class Farkas {  // reuse it: the second problem of a size allocates nothing, up to 100 rows
 public:
  static constexpr Index kTableau = 100;       // rows that the tableau takes; in pure form up to three times as many
  static constexpr Index kTableauAlone = 400;  // likewise in a build without CLP; about a second

  /// True when the linear program is infeasible, as far as the arithmetic shows; u is then a proof for the judge.
  bool propose(const Lcp& problem, Vector& u, const Budget& budget = {});

 private:
  Pyramid pyramid_;
  detail::Scaling scaling_;
  detail::Tableau<long double> tableau_;
  Vector q_, scale_, ray_, pure_u_;
  std::vector<char> free_;
};

/// The problem with A_ij ± margin |A_ij| in columns j with one infinite bound, so that a proof v of it has
/// c_j ≤ −margin Σ_i |A_ij v_i| where hi_j = ∞, ≥ where lo_j = −∞ (c: exact_proof.h): rounding of v is no matter there.
/// `in_column(j)` says where this is required. Free rows: v_i is assumed to have the sign of u_i. same_rows: rows with
/// u_i = 0 demand nothing, so that v_i = 0.
Lcp with_margin(const Lcp& problem, double margin, const Vector& u, bool same_rows,
                const std::function<bool(Index)>& in_column);

/// u, of largest entry 1, as the least whole numbers in its ratios, where these are at most 4096: of problems in round
/// numbers sums have no rounding then, and prove what a third in 53 bits does not. False: there are none.
bool in_whole_numbers(Vector& u);

/// The direction of a ray made a certificate (no friction rows): largest entry 1, noise and wrong signs cut.
void tidy_certificate(const Lcp& problem, Vector& u);

}  // namespace orthant

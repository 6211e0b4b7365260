// core/lcp/judge/certify.h — the judge: the only code that writes Status::solved, Status::rounded or
// Status::infeasible, except distributed_judge.h, which applies the same rule (row_rule.h) to distributed rows.
//
//   Row i of w = A z + b has the terms b_i and A_ij z_j; s_i is the sum of their absolute values. By hand, from z:
//   violation   v_i = how far w_i is from what z_i allows: max(0, −w_i) at lo_i, max(0, w_i) at hi_i, |w_i| between,
//               0 where lo_i = hi_i, ∞ outside. A friction row has the bounds ∓μ z_n, as doubles.
//                 A = 2, b = −1, lo = 0:   z = 0.5: w = 0, v = 0;   z = 0: w = −1, v = 1;   z = 0.6: w = 0.2, v = 0.2.
//   data        β_i = the largest of |b_i| + Σ_j |A_ij β_j'| and, for each j, min(|A_ij z_j|, β_j): the part of another
//               row's data that an entry brings. β_j' = z_j at its own finite bound, else the bound nearest to 0. A
//               friction row has its normal's, too.   A = (2, 1; 1, 2), b = (−3, 0), z = (2, 0): β = (3, 2).
//   solved      v_i ≤ tol min(s_i, β_i) in every row.
//                 z = 0.5 (1 + 1e-11): w = 1e-11, s = 2, β = 1: passes for tol = 1e-10.
//   rounded     each row passes as above or has v_i ≤ 20 ε s_i, and there is no proof of infeasibility. z is the exact
//               solution of a problem whose rows of the second kind differ by at most 20 units in the last place
//               (Oettli & Prager), the others by v_i in b; the distance of z from the solution of this problem is
//               unknown. A v_i of 20 ε 2⁻¹⁰²² (1 + Σ_j |A_ij|) ≤ 1e-290 passes too: z has no more digits.
//                 A = (1, −1; −1, 1 + 1e-12), b = (−1, 1 − 1e-3): z ≈ 1e9, v ≈ 1e-7: s = 1e9, 20 ε s = 4e-6.
//   infeasible  a vector u with uᵀ(A z + b) < 0 for every z within the bounds, although the rows demand uᵀw ≥ 0:
//               u_i ≥ 0 on [lo, ∞), ≤ 0 on (−∞, hi], any on free rows, 0 on boxes and friction rows. Farkas' lemma.
//                 A = −1, b = −1: u = 1.   Or the exact vector near to the doubles in u is one: exact_proof.h.
//               Or all cells searched: cells.h.
//   The verdicts hold in exact arithmetic: sums with bounds of their rounding, rationals where these leave it open.
//   Sources: Oettli & Prager, Numer. Math. 6 (1964); Cottle, Pang & Stone, The Linear Complementarity Problem (1992).
#pragma once

#include <orthant/core/lcp/judge/cells.h>
#include <orthant/core/lcp/judge/certify_cones.h>

#include <functional>
#include <utility>
#include <vector>

namespace orthant {

class Judge {  // the members are scratch: after the first problem of a size nothing is allocated
 public:
  /// Fills w, residual, rounding, miss and coarse from z. Writes solution.status: solved, rounded or infeasible where
  /// that holds, whatever the claim. A proof, in solution.certificate or the ray that is claimed, goes before rounded.
  /// A candidate that does not pass is stalled, or numerical_error where z is not finite or A z overflows; other claims
  /// stand. A certificate that proves nothing is removed. The miss of a z that is far off may be measured by the
  /// largest data of all rows.
  void certify(const Lcp& problem, double tolerance, Claim claim, Solution& solution);

  /// The miss of an unaccepted z that certify() has seen, by each row's own data. One product with A.
  void explain(const Lcp& problem, double tolerance, Solution& solution);

  /// True when the last z is rounded, with a v_i above 1e-4 β_P, the largest β of the rows that A connects with row i:
  /// w is wrong in its first digits. An answer, but another z may be a better one.
  bool coarse() const { return coarse_; }
  /// The residual up to which a multiple of the violations last judged would have been accepted.
  double accepted() const { return accepted_; }
  /// The largest v_i over its limit, of those that do not pass; 0: all do.
  double excess() const { return excess_; }

  /// True when u, or the exact vector that it is nearest to (exact_proof.h), proves that no z in the bounds has the
  /// signs of w that its rows demand.
  bool proves_infeasible(const Lcp& problem, const Vector& u);
  /// The u that last proved it: with its last digits, where doubles hold them.
  const Vector& proof() const { return proof_; }
  /// True when proof() proves it as it is; false: the exact vector that it is nearest to does.
  bool proof_in_doubles() const { return in_doubles_; }
  /// The next certify() of this problem takes the u that `other` has proved last as proved, without a second check. The
  /// problem is the same object, unchanged since. Any other u is checked.
  void trust(const Judge& other) {
    if ((trusted_ = other.proved_) != nullptr) trusted_proof_ = other.proof_, trusted_in_doubles_ = other.in_doubles_;
  }
  /// Frees the scratch of problems with friction discs.
  void release() { cones_.release(); }
  /// Proofs of before count no more: the problem may be another.
  void forget() { proved_ = trusted_ = nullptr; }
  /// True when the cells are all that there are, and none of them holds a solution (cells.h).
  bool proves_infeasible(const Lcp& problem, const std::vector<Cell>& cells) const {
    return no_cell_has_a_solution(problem, cells, stop_);
  }
  /// Polled while cells are checked: where it says true, nothing is proved.
  void set_stop(std::function<bool()> stop) { stop_ = std::move(stop); }

 private:
  using Coupling = std::pair<double, int>;  // how much comes through an entry, or is in a row; its row
  enum class Pass { solved, rounded, no };
  enum class Weighed { proves, open, no };
  void judge(const Lcp& problem, double tolerance, Claim claim, Solution& solution);
  void prepare(const Lcp& problem);
  void certify_cones(const Lcp& problem, double tolerance, Claim claim, Solution& solution);
  Miss overflown(const Lcp& problem, const Solution& s, double tolerance) const;
  void find_bounds(const Lcp& problem, const Vector& z);
  double find_data(const Lcp& problem, const Vector& z);
  bool surely_solved(const Lcp& problem, double tolerance, Solution& s);
  bool surely_missed(const Lcp& problem, double tolerance, Solution& s, double data);
  Pass weigh(const Lcp& problem, double tolerance, Solution& s);
  Weighed weigh_proof(const Lcp& problem, const Vector& u);
  void label_parts(const Lcp& problem);
  void find_part_data(const Lcp& problem);
  void spread(const Lcp& problem, const Vector& z, Vector& x);
  double terms(const Matrix& A);
  void product(const Matrix& A, const Vector& u, bool transposed);

  std::function<bool()> stop_;
  ConeJudge cones_;
  const Lcp *proved_ = nullptr, *trusted_ = nullptr;  // of proof_; of trusted_proof_, the other judge's
  Vector trusted_proof_;
  bool in_doubles_ = false, trusted_in_doubles_ = false;
  Vector lo_, hi_, size_, beta_, data_, part_data_, floor_, zero_w_, inner_, inner_abs_, proof_;
  std::vector<int> part_, first_;  // per row: the first row of its part; per body: its first row
  RowSparse entries_;              // of an operator
  std::vector<Coupling> couplings_, heap_;
  const double *lower_ = nullptr, *upper_ = nullptr;  // with friction's
  double unit_ = 0;                                   // error of a sum of doubles, over s_i
  double accepted_ = 0, excess_ = 0;
  bool coarse_ = false;
  std::vector<long double> g_, g_abs_, g_error_;  // Aᵀu and |A|ᵀ|u|, or A z and |A| |z|; the rounding of Aᵀu
  std::vector<long double> inner_ld_, inner_abs_ld_;
};

}  // namespace orthant

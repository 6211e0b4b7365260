// core/lcp/judge/certify.h — the judge: the only code that writes Status::solved or Status::infeasible.
//
//   w = A z + b is recomputed from the caller's data, in long double where rounding in double may decide; ρ of a
//   Delassus operator is then that of its entries, where these are not too many to form. The natural residual, in units
//   of w,
//     r = max_i d_i |z_i − clamp(z_i − w_i / d_i, lo_i, hi_i)|,   d_i = max(1, max_j |A_ji|),
//   is zero exactly at a solution (friction rows take the bounds ∓μ z_n at the given z). It is a backward error: a z_i
//   that is δ away from its bound costs d_i δ because moving it there changes some w by that much, else |w_i|. d_i ≥ 1
//   makes r at least as strict as the textbook |min(z, w)|.
//   Accepted when
//     r ≤ max(tolerance · β, min(20 ρ, 4e-5 β)),   ρ = ε max_i (|b_i| + Σ_j |A_ij z_j|) ≤ min(1e-6 (1 + β), 1e-4 β):
//   by each part of the problem, a set of rows that A couples: one part's large numbers excuse nothing in another; and
//   by each row in its own unit,
//     r_i ≤ max(tolerance · min(β_i, s_i), min(20 ε t_i, max(4e-5 β_i, 20 ε β))),
//     s_i = |b_i| + Σ_j |A_ij z_j|,   ε s_i ≤ min(1e-6 (1 + β_i), 1e-4 β_i):
//   β_i, of the row's own data or what others' bring into it, is the least with β_i ≥ min(|A_ij z_j|, β_j) for all j (β
//   where nothing does, and for operators too large to be formed; in 4e-5 β_i s_i where nothing does), but not below
//   the least of all data: large data excuse no runaway z in rows that do not feel them, nor does a runaway z excuse
//   these rows.
//     t_i = |b_i| + min(Σ_j |A_ij| u_j, Σ_j |A_ij| u'_j / a_j),   a_j = max_i |A_ij| (of an operator √(A_jj max_k
//     A_kk),
//   which is no less): what the last digits of z leave unknown in a row, each relative to the largest of those that z_j
//   may have been computed from, or of what these do to w. u_j = |z_j| where z_j is exactly at a bound, else the
//   largest |z_k| with a chain of entries from row j to column k through columns that are not at bounds; u'_j likewise
//   of a |z|. So what runs away excuses no row that is not tied to it. Of operators too large to be formed: the largest
//   of the part.
//   If z_i passes by its distance δ to a bound, but not by |w_i|, it is at that bound except for what the move
//   costs: |A_ki| δ in row k. All of them together cost no row more than the w_k that holds z_k at its own bound, and
//   for each what is excused there; and in a box δ is at most 1e-6 of its width (or rounding). A large b_i excuses no
//   z_i that others feel.
//   Below a small multiple of ρ no residual can be known, and a runaway z (|z| ~ 1e15 along a ray), which would make
//   any residual relative to ‖z‖ small, has a large ρ. The scale β = max_i (|b_i| + Σ_j |A_ij β_j|) is what the caller
//   gave: β_j = |z_j| where z_j sits on its own finite bound, else the bound nearest to 0. For 0 ≤ z it is ‖b‖∞.
//   All is relative to β (except ρ where β is near 1), so that the verdict does not depend on the unit of w: z = 0 does
//   not pass for A = [−1e-12], b = [−1e-12].
//   Below the normal numbers η = 2⁻¹⁰⁷⁴ is the absolute rounding: there r_i ≤ 20 η n (1 + max |A_ij|) passes, so that
//   smaller data count as zero.
//
//   A proof of infeasibility is a vector u with, for every feasible z (lo ≤ z ≤ hi, |z_t| ≤ μ z_n),
//     uᵀ(A z + b) < 0,  although the rows demand uᵀw ≥ 0:
//   u_i ≥ 0 where no z_i allows w_i < 0 ([lo, ∞)), u_i ≤ 0 on (−∞, hi], any u_i on a free row, and u_i = 0 on boxes and
//   friction rows, whose w_i has either sign. Farkas' lemma; complete for linear feasibility, and so, by the existence
//   theorem for monotone problems, for every A with xᵀA x ≥ 0. With g = Aᵀu the supremum over z is
//     bᵀu + Σ_j sup g_j z_j:   g_j + Σ μ_t |g_t| (over its friction rows t) ≤ 0 on [lo, ∞), g_j = 0 on free rows.
//   Rounding: sums run in long double with their errors, found out as they arise, on the wrong side. A g_j that misses
//   its sign by no more than κ Σ_i |A_ij u_i|, κ ≤ 32 ε, is let through, but then bᵀu must be so negative that a z
//   using the slack would have ρ ≥ 0.01 β, no digits left. Between that and the ρ of a z that is accepted nothing is
//   claimed: masses 1e10 apart ask for a z that large, which exists. (Beside a proof a z that misses by less than 1e-8
//   β may be called solved: both are true.)
//   Sources: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 1.5, 3.1, 3.7.
#pragma once

#include <orthant/core/lcp/solution.h>

#include <utility>
#include <vector>

namespace orthant {

class Judge {  // the members are scratch: after the first problem of a size nothing is allocated
 public:
  /// Fills w, residual and rounding from z, and replaces solution.status by what can be vouched for:
  /// `claim` (what the solver thinks: its own status, with `solved` meaning "please judge") becomes
  ///   solved           when z passes, whatever the claim; but not a doubtful() one next to a proof,
  ///   infeasible       when the claim is `ray` and solution.certificate proves it,
  ///   numerical_error  when the claim was solved and z is not finite or ρ is too large,
  ///   stalled          when the claim was solved and r is too large (or the claim was `infeasible`: not its to make).
  void certify(const Lcp& problem, double tolerance, Status claim, Solution& solution);

  /// The residual up to which the z last judged would have been accepted.
  double accepted() const { return accepted_; }

  /// Whether the z last judged misses by more than 1e-8 β: rounding excuses that, unless a proof says that there is no
  /// solution.
  bool doubtful(const Solution& solution) const { return solution.residual > 1e-8 * scale_; }

  /// True when u proves that no z in the bounds has the signs of w that its rows demand.
  bool proves_infeasible(const Lcp& problem, const Vector& u);

 private:
  struct Row {
    double residual = 0, data = 0, size = 0;  // r_i, what β takes of it, s_i
    double most = 0, largest = 0;             // of a part: its largest s_j, and |z_j| or a_j |z_j|
    double out = 0, room = 0;                 // how far z_i is out of its bounds, or from the one that w_i asks for
    double held = 0, excused = 0;             // |w_i| at a bound that it holds z_i at; the residual that would pass
    double move = 0;                          // of z_i to its bound
    double charge = 0, borne = 0;             // what moves of others cost here, and may
  };
  using Way = std::pair<double, int>;  // how much comes through an entry, or is in a row; its row

  void prepare(const Lcp& problem);
  void evaluate(const Lcp& problem, Solution& solution, bool extended);
  void certify_cones(const Lcp& problem, double tolerance, Status claim, Solution& solution);
  static double allowed(double tolerance, double rounding, double beta);
  void label_parts(const Lcp& problem);
  bool rows_pass(const Lcp& problem, double tolerance, const Solution& solution);
  bool others_bear_moves(const Lcp& problem);
  template <class Width> void spread(const Lcp& problem, const Width& width, Vector& x);
  void find_unknown(const Lcp& problem, const Solution& solution, bool formed);
  void product(const Matrix& A, const Vector& u, bool transposed);

  RowSparse entries_;  // of an operator
  Vector d_, lo_, hi_, abs_, beta_, reach_, inner_, inner_abs_;
  std::vector<Row> rows_;
  std::vector<int> part_, first_;  // per row: the first row of its part; per body, or column: its first row, or place
  std::vector<Way> ways_, heap_;
  std::vector<char> spoken_, at_bound_;
  bool settled_ = false;    // every r_i is at the rounding level of its own row
  double least_scale_ = 0;  // the smallest |b_i| > 0, or what stands for it
  double scale_ = 0;        // β
  double size_ = 0;         // max s_i
  double accepted_ = 0;
  std::vector<long double> g_, g_abs_, g_error_;  // Aᵀu and |A|ᵀ|u|, or A z and |A| |z|; the rounding of Aᵀu
  std::vector<long double> least_;                // what a slack in g_j is measured by
  std::vector<long double> inner_ld_, inner_abs_ld_;
};

}  // namespace orthant

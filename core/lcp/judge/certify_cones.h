// core/lcp/judge/certify_cones.h — judge of problems with friction discs: one inequality a contact, free of units.
//
//   Blocks, û and D: cones/contact.h. The rest of a block in scaled numbers z' = D⁻¹z, w' = D w, w' = A'z' + q':
//     e_c = ‖z'_c − P_K(z'_c − û'_c)‖,  zero exactly at a solution.                                              (1)
//   e_c changes neither with the units of z, w or lengths, nor with the numbers that one contact is measured in.
//   Solved when e_c ≤ tolerance · min(β, s_c) for every block; rounded when
//     e_c ≤ max(tolerance · min(β, s_c), 20 ε t_c),   ε t_c ≤ 1e-6 β,                                            (2)
//     β    largest data of the blocks that A couples with this one: ‖q'‖, or at a finite bound what it brings into w',
//     s_c  = ‖ |q'_c| + Σ_j |A'_cj z'_j| ‖, the terms that w'_c is the sum of,
//     t_c  = ‖ |q'_c| + Σ_j |A'_cj| max |z'| ‖, the largest z' of the coupled blocks: the part that the last digits of
//   z leave unknown in w'_c. So large data excuse nothing elsewhere, and a runaway z (ε t_c > 1e-6 β) is no answer.
//   Sums run in long double. The subtraction in (1) loses up to 4 ε ‖z'_c‖, which solved has to bear as well.
//   Proof of infeasibility: certify.h, with the disc's support function,
//     sup gᵀz over ‖z_T‖ ≤ μ z_n = (g_n + μ‖g_T‖) z_n.
//   Residuals for comparison, of a z alone, no verdict:
//     scale-free  ‖(e_c)‖ / ‖q'‖,    natural  ‖z − P_K(z − û)‖ / ‖q‖  (Acary, Brémond & Huber 2018; ρ = 1).
//   The natural one depends on units.
#pragma once

#include <orthant/core/lcp/cones/contact.h>
#include <orthant/core/lcp/solution.h>

namespace orthant {

struct ConeResiduals {
  double scale_free = kInf, natural = kInf;
};

/// 0 / 0 counts as 0. Problems without discs have these, too.
ConeResiduals cone_residuals(const Lcp& problem, const Vector& z);

class ConeJudge {  // the members are scratch: most problems allocate nothing after the first of a size
 public:
  /// Frees the scratch: some 200 B a contact.
  void release() { *this = {}; }
  /// Fills w, residual (max e_c / d_c, units of w), rounding and miss of s from its z. True when (2) holds.
  bool passes(const Lcp& problem, double tolerance, Solution& s);
  /// Of the last z: no w can be known (not finite, or a runaway).
  bool unknown() const { return unknown_; }
  /// The last z passed, but in some block by what rounding excuses only.
  bool rounded() const { return rounded_; }

 private:
  bool sum(const Lcp& problem, Solution& s);
  void find_residuals(Solution& s);
  bool surely_solved(const Lcp& problem, double tolerance) const;
  bool weigh(const Lcp& problem, double tolerance, Solution& s);
  void couple(const Matrix& A);

  cones::Blocks blocks_;
  Vector d_;
  std::vector<long double> w_;
  std::vector<double> terms_, unknown_terms_;  // per row: |b| + |A||z|; |b| + |A| times the largest z'
  std::vector<double> e_, lost_;               // per block
  std::vector<double> block_z_, block_w_;
  std::vector<int> part_;
  bool unknown_ = false, rounded_ = false;
};

}  // namespace orthant

// experiments/storm/exact_judge.h — a third judge, written apart from certify(): every sum exact.
//
//   Claim of `solved`, as a backward error: z̄ near z solves, without any tolerance, a problem near the one given.
//   Row by row z stays where it is when |w_i| ≤ r_i, else z̄_i is the bound that the sign of w_i asks for (friction
//   rows after their normals, ∓μ z̄_n), and the move may cost no more than r_i: |z̄_i − z_i| d_i ≤ r_i, d_i = max(1,
//   max_j |A_ji|).
//   Then, with w̄ = A z̄ + b,
//     |w̄_i| ≤ T_i on rows that stayed,  w̄_i ≥ −T_i at lo,  w̄_i ≤ T_i at hi,
//     r_i = max(tolerance · min(β_i, s_i), min(20 ε t_i, max(4e-5 β_i, 20 ε β))),
//     T_i = (1 + m_i) r_i, m_i of the rows that moved being felt in row i, in a box by 1e-6 of its width at most,
//     ε s_i ≤ min(1e-6 (1 + β_i), 1e-4 β_i),  ε max s ≤ min(1e-6 (1 + β), 1e-4 β),
//   s_i = |b_i| + Σ_j |A_ij z_j|, t_i what the last digits of z leave unknown in a row (certify.h; of an operator with
//   a_j = √(A_jj max_k A_kk), which is no less than any entry of column j), β of the data alone, β_i
//   what of them reaches the row (certify.h). r_i is (n + 1) ε/2 s_i more, what sums of doubles may lose, and n + 1 of
//   the least doubles: products may be less than any.
//   max s and β are of each part of the problem, rows that A couples. Of an operator, where an entry is a sum over
//   bodies, the sizes s, t, β are those of its terms; max s is of the entries.
//
//   Claim of `infeasible`: uᵀ(A z + b) < 0 for every z within the bounds, u with the signs that make uᵀw ≥ 0 a
//   consequence. Exactly; or up to roundings of Aᵀu, where every z that uses them is so large that w is unknown.
//
//   Arithmetic: rationals up to kRational rows and for every proof, else 113 bits, in which products of doubles are
//   exact.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <string>

namespace orthant {

struct Finding {
  bool holds = false;
  double error = kInf;  // of a solution: the largest violation over β; of a proof: κ, 0 when it is exact
  std::string why;      // empty when it holds
};

Finding examine_solution(const Lcp& problem, const Vector& z, double tolerance);
Finding examine_proof(const Lcp& problem, const Vector& u);

}  // namespace orthant

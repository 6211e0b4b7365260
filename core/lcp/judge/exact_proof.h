// core/lcp/judge/exact_proof.h — Farkas' proof of infeasibility in rationals, for a u with lost last digits too.
//
//   No z within the bounds has the signs of w = A z + b that its rows demand when û_i has the sign of its row and
//     c_j ≤ 0 where hi_j = ∞, ≥ 0 where lo_j = −∞,  c_j = (Aᵀû)_j + Σ μ ‖(Aᵀû)_T‖ over the friction T of normal j,
//     bᵀû + Σ_j max(c_j lo_j, c_j hi_j) < 0.                                                                      (1)
//   û = u where that holds. Mostly c_j must be 0 in so many columns that no vector of doubles has it. Then û is
//     û_f = u_f in rows f without a pivot, the others by elimination from c_j = 0                                  (2)
//   in the columns with |c_j| ≤ 2⁻³⁰ Σ_i |A_ij u_i|, of an operator also of its velocities Wᵀu; if (1) fails for that
//   û, only in those with the wrong sign. The largest u_i get the pivots, so that signs stay. E.g. the kernel of
//   Aᵀ = (1, 3): u = (1, −0.333…) means û = (1, −1/3).
//   Pivots and û come from arithmetic modulo a prime (dixon_lifting.h); (1) checks them in rationals.
//   Cost: O(k³) for k pivots, and O(k²) for each 31 digits of û, which has at most some 53 k.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 3.1.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <functional>
#include <vector>

namespace orthant {

enum class Proved { no, by_exact_neighbor, by_doubles };  // by û, which no doubles hold; by u itself

/// Tells if (1) holds for û = u or the û of (2). u has the signs of its rows and is 0 on boxes and friction rows; A and
/// b are finite. u becomes a multiple of û where doubles hold one: then (1) holds for u as it is. Else u stays, so that
/// it proves again. stop() is polled; where it says true: no.
Proved prove_exactly(const Lcp& problem, Vector& u, const std::function<bool()>& stop = {});

/// The columns j in which c_j of û = u is not what (1) demands. u as above.
std::vector<Index> columns_of_wrong_sign(const Lcp& problem, const Vector& u);

}  // namespace orthant

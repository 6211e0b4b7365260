// core/lcp/judge/active_set.h — active set of a solution: the side of each row, and local uniqueness.
//
//   lower     z_i = lo_i, w_i > 0       inside   w_i = 0, lo_i < z_i < hi_i       upper   z_i = hi_i, w_i < 0
//   degenerate   z_i at a bound and w_i = 0;   rows with lo_i = hi_i count as lower, friction rows have ∓μ z_n for
//                bounds. Both rows of a disc: inside where ‖z_T‖ < μ z_n (stick), upper where it slides.
//   "=": |w_i| ≤ t or d_i · distance ≤ t, with t = max(residual, 20 ρ) and d_i as the judge has them (certify.h).
//   Near a solution only the degenerate rows can change sides. Each choice of sides is a linear system; if all of them
//   are regular, the solution is isolated. Where a system is singular to working precision it may lie on a face of
//   solutions; with no degenerate row, it does, up to rounding.
//   Cost: one LU factorization a choice, O(n³) dense. Not decided beyond 1000 rows or 256 choices, or with discs.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 3.6 (nondegenerate matrices).
#pragma once

#include <orthant/core/lcp/solution.h>

#include <string_view>
#include <vector>

namespace orthant {

enum class Isolation { isolated, maybe_not, not_decided };
std::string_view name(Isolation isolation);

struct ActiveSet {
  std::vector<Index> lower, inside, upper, degenerate;  // ascending; each row is in one of them
  Isolation isolation = Isolation::not_decided;         // maybe_not: other solutions may touch this one
};

/// `solution` must hold z and w of n entries, as certify() leaves them (else std::invalid_argument).
ActiveSet active_set(const Lcp& problem, const Solution& solution);

}  // namespace orthant

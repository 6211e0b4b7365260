// solvers/proof/disc_cases.h — exhaustion of contact cases: a problem with friction discs has no solution.
//
//   Each contact is open, sticks, or slides along d(θ) with z_T = −μ z_n d(θ), w_T = κ d(θ), κ ≥ 0. With θ in an arc
//   [α, β] this lies in linear bounds:
//     open     z = 0,  w_n ≥ 0
//     sticks   w = 0,  z in the cone of (1, 0), (1, μ d(α)), (1, μ d(β)), (1, μ d(mid) / cos(half the arc))
//     slides   w_n = 0, w_T in the cone of d(α), d(β);  z in that of the last three, with −μ
//   A case is excluded where the linear program of its bounds has no solution (solvers/proof/farkas.h), even with every
//   coefficient raised by 1e-9 of the largest and A_nn z_n ≤ 1e5 ‖b‖∞ (beyond, rounding makes up for what contacts that
//   squeeze a body contradict). Else its widest arc is halved. No solution exists when all cases are excluded.
//   Cost: one linear program a case, at most 4000 cases, of at most four contacts; only after a solver has failed.
//   Source: branch and bound over a disjunction of polyhedra, Cottle, Pang & Stone (1992), ch. 1.2.
#pragma once

#include <orthant/core/lcp/problem.h>

namespace orthant {

/// True: no z solves the problem. False: one may, or the problem has other rows than contacts with and without discs,
/// or too many.
bool excludes_all_cases(const Lcp& problem);

}  // namespace orthant

// solvers/proof/farkas_simplex.h — Farkas proofs at scale: infeasibility from a sparse linear program.
//
//   Constraints of the problem as it stands (no pure form): lo ≤ z ≤ hi, (A z + b)_i ≥ 0, ≤ 0 or = 0 where the row's
//   bounds demand it, |z_t| ≤ μ z_n on friction rows. The dual simplex method (CLP) ends on a solution or on a row of
//   B⁻¹, B the last basis, that is the proof u. Double arithmetic leaves (Aᵀu)_j ≈ 1e-12 where it must be 0, which
//   proves nothing; so u is solved for again from the basis, A_NJᵀ u_N = −A_rJᵀ (N: tight rows, J: basic columns, r:
//   the row that cannot be met), by sparse LU with residuals in long double.  certify.h checks the result.
//   Infeasibility below 1e-9 of the largest |b| is not detected. Worst case exponential; usually some n pivots.
//   Sources: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 1.2, 3.1; Forrest, CLP (COIN-OR).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/budget.h>

namespace orthant {

/// Whether this build has CLP. Without it propose_by_simplex() proposes nothing.
bool has_simplex();

/// True when the linear program is infeasible, as far as it can tell; u (n entries) is then a proof to be judged.
bool propose_by_simplex(const Lcp& problem, const Budget& budget, Vector& u);

}  // namespace orthant

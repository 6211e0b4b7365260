// core/lcp/mcp.h — mixed complementarity problems, nonlinear: two callbacks, F(z) and its Jacobian.
//
//   Find lo ≤ z ≤ hi such that, row by row,
//     z_i = lo_i ⇒ F_i(z) ≥ 0,   z_i = hi_i ⇒ F_i(z) ≤ 0,   otherwise F_i(z) = 0.
//   lo = 0, hi = ∞: a nonlinear complementarity problem; lo = −∞, hi = ∞: a system of equations.
//   The judge: r_i = d_i |z_i − clamp(z_i − F_i / d_i, lo_i, hi_i)|, d_i = max(1, max_j |J_ji|), in the units of F, is
//   zero exactly at a solution. Accepted when, for each row, r_i ≤ tolerance, or r_i ≤ 20 ρ_i with
//   ρ_i = ε (|F_i| + Σ_j |J_ij z_j|) ≤ 1e-6: no row's rounding excuses another.
//   The tolerance is absolute: what F is made of only the caller knows.
//   Source: Facchinei & Pang, Finite-Dimensional Variational Inequalities and Complementarity Problems (2003), ch. 1.
#pragma once

#include <orthant/core/lcp/solution.h>

#include <functional>

namespace orthant {

struct Mcp {
  Vector lo, hi;                                      // n
  std::function<void(const Vector& z, Vector& F)> F;  // F, n on entry and on return; called within the bounds only
  std::function<void(const Vector& z, Matrix& J)> jacobian;  // J_ij = ∂F_i/∂z_j, n × n, dense or RowSparse

  Index size() const { return lo.size(); }
};

/// Throws std::invalid_argument in words: bounds of different length, lo > hi or NaN, a callback that is missing.
void check(const Mcp& problem);

/// F(z), and J(z): throws std::invalid_argument when the callback left them in another shape. False: not all finite.
bool evaluate(const Mcp& problem, const Vector& z, Vector& F);
bool evaluate(const Mcp& problem, const Vector& z, Matrix& J);

/// Fills w = F(z), residual and rounding, and replaces s.status: `solved` when z passes, whatever the claim; a claim of
/// solved that does not pass becomes stalled, or numerical_error where F is not finite or ρ too large.
void certify(const Mcp& problem, double tolerance, Status claim, Solution& s);

}  // namespace orthant

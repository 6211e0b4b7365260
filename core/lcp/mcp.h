// core/lcp/mcp.h — mixed complementarity problems, nonlinear: two callbacks, F(z) and its Jacobian.
//
//   Find lo ≤ z ≤ hi such that, row by row,
//     z_i = lo_i ⇒ F_i(z) ≥ 0,   z_i = hi_i ⇒ F_i(z) ≤ 0,   otherwise F_i(z) = 0.
//   lo = 0, hi = ∞: a nonlinear complementarity problem; lo = −∞, hi = ∞: a system of equations.
//   The judge: that of the linear problem A = J(z), b = F(z) − J(z) z, whose w at z is F(z) (judge/certify.h). F_i is
//   small where it is small compared with its terms: F = −e^(−z) at z = 26 is 5e-12, but s = 2.7e-10.
//   The Jacobian is compared with F: where z passes, F is evaluated at two more points next to z. A row is not solved
//   if its change is off by more than half its terms |J_ij z_j|, unless F_i is within the tolerance of that change.
//   Otherwise a Jacobian too large by 1e12 would accept any F.
//   Underflow: F = −e^(−z) and its Jacobian are 0 from z = 746 on. A row with |F_i| + Σ_j |J_ij| max(1, |z_j|) ≤ 1e-290
//   is compared with the start and with points r between z and the origin. Bisection between z and an r with
//   |F_i| > 1e-290 finds the place where F_i falls below that. z is not solved if F_i violates there by less than
//   1e-280 and the place is farther from z than 1e-10 of |z| and |r|. A root, a flat part or a row of zeros passes.
//   Source: Facchinei & Pang, Finite-Dimensional Variational Inequalities and Complementarity Problems (2003), ch. 1.
#pragma once

#include <orthant/core/lcp/judge/certify.h>

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

/// Fills w = F(z), residual, rounding and miss, and replaces s.status: solved or rounded when z passes, whatever the
/// claim, and J fits F; a candidate that does not becomes stalled, or numerical_error where F or J is not finite.
/// `start` is where the solver began, if it is known: F is compared with its value there.
void certify(const Mcp& problem, double tolerance, Claim claim, Solution& s, const Vector* start = nullptr);

}  // namespace orthant

// core/lcp/judge/error_bound.h — error bound of a given z: ‖z − z*‖∞ ≤ bound, rounding included.
//
//   With the natural residual r = z − clamp(z − w, lo, hi) the error e = z − z* solves (I − D + D A) e = r for some
//   diagonal D, 0 ≤ D ≤ I, for any (fixed) bounds. The best of the bounds that apply is taken:
//     H₊ (K, strictly diagonally dominant …), rows divided by A_ii:  |e| ≤ v for any v with ⟨A⟩ v ≥ diag(A) |r|. One
//              sparse LU; the sign of ⟨A⟩ v − diag(A) |r| is checked with its rounding, v enlarged until it holds.
//     positive definite, symmetric or not:  ‖e‖₂ ≤ ‖d r + Aᵀr‖₂ / λ, r for w/d, d = max A_ii,  λ ≤ λ_min((A + Aᵀ)/2)
//     proved by Cholesky (definite.h),
//              found by halving from the least diagonal entry: within a factor 1.4.
//     P, n ≤ 12:  each e_j is monotone in each D_i (a ratio of two functions affine in D_i, whose denominator, a
//              positive combination of principal minors, never vanishes): |e_j| is at most the largest of its 2ⁿ values
//              at D_i ∈ {0, 1}, where e_i = r_i outside α and A_αα e_α = r_α − A_αᾱ r_ᾱ.
//   All of these are P-matrices: the solution is unique. Elsewhere, with friction rows, or where a proof fails in
//   floating point, the bound is infinite and gives no information about z.
//   Sources: Mathias & Pang, Linear Algebra Appl. 132 (1990); Chen & Xiang, Math. Program. A 106 (2006).
#pragma once

#include <orthant/core/lcp/solution.h>

#include <functional>

namespace orthant {

/// In units of z; kInf where none is known or z is not finite. Throws std::invalid_argument unless z has n entries.
/// No solver computes it: it costs factorizations.
/// `stop` is polled; where it says true, the bound is what is proved by then, most often none.
double error_bound(const Lcp& problem, const Vector& z, const std::function<bool()>& stop = {});

}  // namespace orthant

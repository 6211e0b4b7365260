// core/lcp/problem.h — linear complementarity problem (LCP): type of the problem for all solvers.
//
//   Find z with lo ≤ z ≤ hi and w = A z + b such that, row by row,
//     z_i = lo_i ⇒ w_i ≥ 0,   z_i = hi_i ⇒ w_i ≤ 0,   otherwise w_i = 0.
//   LCP row: [0, ∞).  Free (equality) row: (−∞, ∞).  Box row: [lo, hi].
//   Friction of normal row n, one row i: the bounds are ∓μ z_n, so |z_i| ≤ μ z_n (Coulomb in the plane).
//   Friction of normal row n, two rows T: a disc (Coulomb in space; rolling resistance):
//     |z_T|₂ ≤ μ z_n,   w_T = 0 where |z_T| < μ z_n,   else w_T = −κ z_T with κ ≥ 0.
//   One normal may bear several intervals and discs: sliding, rolling, spinning (cones/contact.h).
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 1; Acary & Brogliato, Numerical
//   Methods for Nonsmooth Dynamical Systems (2008), ch. 3.
#pragma once

#include <orthant/core/lcp/matrix.h>

#include <vector>

namespace orthant {

struct Friction {
  Index normal = 0, first = 0;  // rows: z_n, and the first of the friction rows, which are contiguous
  Index rows = 1;               // 1: interval |z_first| ≤ μ z_n; 2: disc
  double mu = 0;                // ≥ 0
};

struct Lcp {
  Matrix A;                        // n × n
  Vector b, lo, hi;                // n
  std::vector<Friction> friction;  // empty without friction; such a row has lo = −∞, hi = ∞

  Index size() const { return b.size(); }

  /// Some friction is a disc.
  bool discs() const {
    for (const Friction& f : friction)
      if (f.rows > 1) return true;
    return false;
  }

  /// The pure problem 0 ≤ z ⊥ M z + q ≥ 0.
  static Lcp standard(Matrix M, const Vector& q);
};

/// Throws std::invalid_argument naming the field, the value and the rule when the parts do not fit together: shapes,
/// bounds (lo ≤ hi, neither NaN), friction rows (one or two an entry, one entry a row, their own bounds infinite, the
/// normal a row with lo ≥ 0 that is no friction row itself). The entries of A and b are not checked here: see finite().
void check(const Lcp& problem);

/// The problem with a dense matrix, or with one by rows: itself where it is stored so, else in `room`.
const Lcp& with_dense_matrix(const Lcp& problem, Lcp& room);
const Lcp& with_rows(const Lcp& problem, Lcp& room);

/// Every number of A and b is finite.
bool finite(const Lcp& problem);

}  // namespace orthant

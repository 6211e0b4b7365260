// solvers/external/scaled_problem.h — scaled problem for methods with absolute tolerances.
//
//   A' = R A C,  b' = R b,  z = C z',  w' = R w,  R and C diagonal, chosen so that entries are near 1:
//     symmetric with A_ii > 0   R_i = C_i = A_ii^(−1/2);     else   scaling.h, where entries are far apart;
//   then both by one number each, so that max |A'_ij| = 1 and max |w'_i| = 1 at z = 0 (projected on the bounds).
//   R_i = ρ C_i for some number ρ where `symmetric`, so that A' is symmetric too.
// A Delassus operator is formed. Problems without friction rows.
#pragma once

#include <orthant/solvers/linear_algebra/columns.h>
#include <orthant/solvers/linear_algebra/scaling.h>

namespace orthant {

class ScaledProblem {  // reuse it
 public:
  Columns A;
  Vector b, lo, hi;
  bool symmetric = false;

  void load(const Lcp& problem);
  Index size() const { return b.size(); }

  void enter(const Vector& z, Vector& scaled) const { scaled = z.cwiseQuotient(column_); }
  void leave(const Vector& scaled, Vector& z) const { z = scaled.cwiseProduct(column_); }

  template <class X> void multiply(const X& x, Vector& y) const {  // y ← A x
    y.resize(size());
    y.setZero();
    for (Index j = 0; j < size(); ++j) A.each(j, [&](int i, double v) { y[i] += v * x[j]; });
  }
  template <class X> void add_transposed(const X& x, Vector& y) const {  // y ← y + Aᵀ x
    for (Index j = 0; j < size(); ++j) A.each(j, [&](int i, double v) { y[j] += v * x[i]; });
  }

 private:
  detail::Scaling scaling_;
  Vector row_, column_, start_, w_;
};

}  // namespace orthant

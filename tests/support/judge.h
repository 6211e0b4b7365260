// tests/support/judge.h — a second judge, written apart from core/lcp/certify.cpp: dense, long double, row by row.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace orthant {

/// max_i |z_i − clamp(z_i − w_i, lo_i, hi_i)| / (max |b| + max_i Σ_j |A_ij z_j|); 1e30 when something is not finite.
inline double independent_residual(const Lcp& problem, const Vector& z) {
  DenseMatrix A;
  to_dense(problem.A, A);
  const Index n = problem.size();
  long double residual = 0, scale = 0;
  for (Index i = 0; i < n; ++i) {
    long double w = problem.b[i], terms = std::abs(w), lo = problem.lo[i], hi = problem.hi[i];
    for (Index j = 0; j < n; ++j) {
      const long double term = static_cast<long double>(A(i, j)) * z[j];
      w += term;
      terms += std::abs(term);
    }
    for (const Friction& f : problem.friction)
      if (f.row == i) {
        hi = static_cast<long double>(f.mu) * z[f.normal];
        lo = -hi;
      }
    if (!std::isfinite(w) || lo > hi + 1e-15L * std::abs(hi)) return 1e30;
    const long double next = std::min(std::max(static_cast<long double>(z[i]) - w, lo), hi);
    residual = std::max(residual, std::abs(static_cast<long double>(z[i]) - next));
    scale = std::max(scale, terms);
  }
  return static_cast<double>(scale > 0 ? residual / scale : residual);
}

}  // namespace orthant

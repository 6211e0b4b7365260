// experiments/support/independent_judge.h — second judge, independent of core/lcp/judge/certify.cpp:
// in long double, entry by entry.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace orthant {

/// visit(i, j, A_ij), row by row.
template <class Visit> void each_entry(const Matrix& A, const Visit& visit) {
  if (const auto* rows = std::get_if<RowSparse>(&A)) {
    for (Index i = 0; i < rows->rows; ++i)
      for (int k = rows->start[static_cast<std::size_t>(i)]; k < rows->start[static_cast<std::size_t>(i) + 1]; ++k)
        visit(i, static_cast<Index>(rows->column[static_cast<std::size_t>(k)]),
              rows->value[static_cast<std::size_t>(k)]);
    return;
  }
  DenseMatrix dense;
  to_dense(A, dense);
  for (Index i = 0; i < dense.rows(); ++i)
    for (Index j = 0; j < dense.cols(); ++j) visit(i, j, dense(i, j));
}

/// w = A z + b, and |b| + |A| |z|, its terms added up.
struct Exact {
  std::vector<long double> w, terms;
};
inline Exact exact_w(const Lcp& problem, const Vector& z) {
  Exact e{{problem.b.begin(), problem.b.end()}, {}};
  for (const long double b : e.w) e.terms.push_back(std::abs(b));
  each_entry(problem.A, [&](Index i, Index j, double a) {
    const long double term = static_cast<long double>(a) * z[j];
    e.w[static_cast<std::size_t>(i)] += term;
    e.terms[static_cast<std::size_t>(i)] += std::abs(term);
  });
  return e;
}

/// Residuals of a z; both ∞ when something is not finite, or a friction row's bounds are crossed (z_n < 0).
struct Achieved {
  double residual = kInf;  // max_i |z_i − clamp(z_i − w_i, lo_i, hi_i)|: textbook, without weights       [units of w]
  double size = kInf;      // max_i (|b_i| + Σ_j |A_ij z_j|): w cannot be known below ε times that        [units of w]
};
inline Achieved achieved(const Lcp& problem, const Vector& z) {
  const Exact e = exact_w(problem, z);
  std::vector<long double> lo(problem.lo.begin(), problem.lo.end()), hi(problem.hi.begin(), problem.hi.end());
  for (const Friction& f : problem.friction) {
    const auto row = static_cast<std::size_t>(f.row);
    hi[row] = static_cast<long double>(f.mu) * z[f.normal];
    lo[row] = -hi[row];
  }
  long double residual = 0, size = 0;
  for (std::size_t i = 0; i < e.w.size(); ++i) {
    const long double at = z[static_cast<Index>(i)];
    if (!std::isfinite(e.w[i]) || lo[i] > hi[i] + 1e-15L * std::abs(hi[i])) return {};
    const long double next = std::min(std::max(at - e.w[i], lo[i]), hi[i]);
    residual = std::max(residual, std::abs(at - next));
    size = std::max(size, e.terms[i]);
  }
  return {static_cast<double>(residual), static_cast<double>(size)};
}

/// The residual relative to that size; ∞ when something is not finite.
inline double independent_residual(const Lcp& problem, const Vector& z) {
  const auto [residual, size] = achieved(problem, z);
  return size > 0 && residual < kInf ? residual / size : residual;
}

/// ε max_i (|b_i| + Σ_j |A_ij z_j|) / (1 + ‖b‖∞): above 1e-6 z has run away along a ray, and w is anybody's guess.
inline double runaway(const Lcp& problem, const Vector& z) {
  return 0x1p-52 * achieved(problem, z).size / (1 + problem.b.lpNorm<Eigen::Infinity>());
}

/// uᵀ(A z + b) < 0 for every z within the bounds, although the rows demand uᵀw ≥ 0; up to 32 roundings in Aᵀu.
inline bool independent_proof(const Lcp& problem, const Vector& u) {
  const Index n = problem.size();
  if (u.size() != n || !u.allFinite()) return false;
  std::vector<char> friction(static_cast<std::size_t>(n));
  for (const Friction& f : problem.friction) friction[static_cast<std::size_t>(f.row)] = 1;
  std::vector<long double> g(static_cast<std::size_t>(n)), slack(g);
  long double value = 0;
  for (Index i = 0; i < n; ++i) {
    const bool below = problem.lo[i] > -kInf, above = problem.hi[i] < kInf;
    const bool fixed = friction[static_cast<std::size_t>(i)] != 0 || (below && above);
    if ((fixed && u[i] != 0) || (below && u[i] < 0) || (above && u[i] > 0)) return false;
    value += static_cast<long double>(problem.b[i]) * u[i];
  }
  each_entry(problem.A, [&](Index i, Index j, double a) {
    const long double term = static_cast<long double>(a) * u[i];
    g[static_cast<std::size_t>(j)] += term;
    slack[static_cast<std::size_t>(j)] += 32 * 0x1p-52L * std::abs(term);
  });
  for (const Friction& f : problem.friction) {  // |z_t| ≤ μ z_n: the worst of both signs, paid by z_n
    g[static_cast<std::size_t>(f.normal)] += f.mu * std::abs(g[static_cast<std::size_t>(f.row)]);
    slack[static_cast<std::size_t>(f.normal)] += f.mu * slack[static_cast<std::size_t>(f.row)];
  }
  for (Index j = 0; j < n; ++j) {
    const auto k = static_cast<std::size_t>(j);
    if (friction[k] != 0) continue;
    const double bound = g[k] > 0 ? problem.hi[j] : problem.lo[j];
    if (std::abs(bound) < kInf)
      value += g[k] * bound;
    else if (std::abs(g[k]) > slack[k])
      return false;
  }
  return value < 0;
}

}  // namespace orthant

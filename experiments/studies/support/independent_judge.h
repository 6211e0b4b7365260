// experiments/studies/support/independent_judge.h — second judge, independent of core/lcp/judge/certify.cpp:
// in long double, entry by entry.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace orthant {

/// visit(i, j, A_ij) for all entries, the columns of each row ascending; column by column where A is dense.
template <class Visit> void each_entry(const Matrix& A, const Visit& visit) {
  if (for_each_entry(A, visit)) return;
  Matrix formed;
  to_dense(A, as<DenseMatrix>(formed));
  for_each_entry(formed, visit);
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
    const auto row = static_cast<std::size_t>(f.first);
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

/// The scale-free residual of problems with friction discs (core/lcp/judge/certify_cones.h), in long double: of each
/// contact what z misses of the law, in units in which the contact's own part of A has mean 1. Normal rows [0, ∞).
inline double independent_scale_free(const Lcp& problem, const Vector& z) {
  const Exact e = exact_w(problem, z);
  const auto n = static_cast<std::size_t>(problem.size());
  std::vector<long double> diagonal(n, 0), d(n, 0);
  each_entry(problem.A, [&](Index i, Index j, double a) {
    if (i == j) diagonal[static_cast<std::size_t>(i)] = std::abs(static_cast<long double>(a));
  });
  std::vector<std::vector<const Friction*>> of(n);
  std::vector<char> tangential(n, 0);
  for (const Friction& f : problem.friction) {
    of[static_cast<std::size_t>(f.normal)].push_back(&f);
    for (Index r = f.first; r < f.first + f.rows; ++r) tangential[static_cast<std::size_t>(r)] = 1;
  }
  const long double largest = *std::max_element(diagonal.begin(), diagonal.end());
  const auto unit = [&](long double sum, Index count) {
    const long double mean = sum / static_cast<long double>(count);
    return 1 / std::sqrt(mean > 0 ? mean : largest > 0 ? largest : 1);
  };
  long double missed = 0, data = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (tangential[i] != 0) continue;
    long double sum = diagonal[i];
    Index count = 1;
    if (!of[i].empty())
      for (Index r = 0; r < of[i][0]->rows; ++r, ++count)
        sum += diagonal[static_cast<std::size_t>(of[i][0]->first + r)];
    d[i] = unit(sum, count);
    struct Part {
      std::vector<long double> t;  // of x = z' − û'
      long double mu, length;
    };
    std::vector<Part> parts;
    long double normal = z[static_cast<Index>(i)] / d[i] - d[i] * e.w[i];
    for (const Friction* f : of[i]) {
      long double own = 0;
      for (Index r = 0; r < f->rows; ++r) own += diagonal[static_cast<std::size_t>(f->first + r)];
      const long double dt = f == of[i][0] ? d[i] : unit(own, f->rows);
      Part part{{}, f->mu * d[i] / dt, 0};
      long double slip = 0, length = 0;
      for (Index r = f->first; r < f->first + f->rows; ++r) {
        const long double u = dt * e.w[static_cast<std::size_t>(r)], x = z[r] / dt - u;
        d[static_cast<std::size_t>(r)] = dt;
        slip += u * u, length += x * x;
        part.t.push_back(x);
      }
      normal -= part.mu * std::sqrt(slip);
      part.length = std::sqrt(length);
      parts.push_back(part);
    }
    // The nearest point of the cone by bisection of the slope: simple, slow, and not the library's way.
    const bool free = problem.lo[static_cast<Index>(i)] == -kInf;
    long double low = 0, high = std::abs(normal) + 1;
    for (const Part& part : parts) high += part.mu * part.length;
    const auto slope = [&](long double a) {
      long double value = a - normal;
      for (const Part& part : parts)
        if (part.length > part.mu * a) value -= part.mu * (part.length - part.mu * a);
      return value;
    };
    long double a = normal;
    if (!free) {
      for (int k = 0; k < 200; ++k) (slope((low + high) / 2) > 0 ? high : low) = (low + high) / 2;
      a = slope(0) >= 0 ? 0 : (low + high) / 2;
    }
    const long double off = z[static_cast<Index>(i)] / d[i] - a;
    missed += off * off;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const Part& part = parts[k];
      const long double share = part.length > part.mu * a ? part.mu * a / part.length : 1;
      for (std::size_t r = 0; r < part.t.size(); ++r) {
        const auto row = of[i][k]->first + static_cast<Index>(r);
        const long double off_t = z[row] / d[static_cast<std::size_t>(row)] - share * part.t[r];
        missed += off_t * off_t;
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    data += d[i] * problem.b[static_cast<Index>(i)] * d[i] * problem.b[static_cast<Index>(i)];
  return missed == 0 ? 0 : static_cast<double>(std::sqrt(missed / data));
}

/// uᵀ(A z + b) < 0 for every z within the bounds, although the rows demand uᵀw ≥ 0; up to 32 roundings in Aᵀu.
inline bool independent_proof(const Lcp& problem, const Vector& u) {
  const Index n = problem.size();
  if (u.size() != n || !u.allFinite()) return false;
  std::vector<char> friction(static_cast<std::size_t>(n));
  for (const Friction& f : problem.friction)
    for (Index r = f.first; r < f.first + f.rows; ++r) friction[static_cast<std::size_t>(r)] = 1;
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
    const auto first = static_cast<std::size_t>(f.first), last = first + static_cast<std::size_t>(f.rows) - 1;
    g[static_cast<std::size_t>(f.normal)] +=
        f.mu * (first == last ? std::abs(g[first]) : std::hypot(g[first], g[last]));
    slack[static_cast<std::size_t>(f.normal)] += f.mu * (slack[first] + (first == last ? 0 : slack[last]));
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

#include "experiments/studies/verdict_storm/shrink.h"

#include <cmath>
#include <vector>

namespace orthant {
namespace {

Lcp without(const Lcp& p, Index gone) {
  for (const Friction& f : p.friction)  // discs go as a whole
    if (f.rows == 2 && (gone == f.first || gone == f.first + 1 || gone == f.normal)) {
      Lcp q = p;
      std::erase_if(q.friction, [&](const Friction& g) { return g.first == f.first; });
      for (Index row = f.first; row < f.first + 2; ++row) q.lo[row] = q.hi[row] = 0;
      if (q.size() <= 2) return q;
      return without(without(q, f.first + 1), f.first);
    }
  const Index n = p.size() - 1;
  const auto from = [gone](Index i) { return i < gone ? i : i + 1; };
  const auto& A = std::get<DenseMatrix>(p.A);
  DenseMatrix smaller;
  smaller.resize(n, n);
  Lcp q;
  for (Vector* each : {&q.b, &q.lo, &q.hi}) each->resize(n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) smaller(i, j) = A(from(i), from(j));
    q.b[i] = p.b[from(i)], q.lo[i] = p.lo[from(i)], q.hi[i] = p.hi[from(i)];
  }
  q.A = std::move(smaller);
  for (Friction f : p.friction) {
    if (f.first == gone) continue;
    if (f.normal == gone) {  // friction without its normal: none at all
      const Index row = f.first < gone ? f.first : f.first - 1;
      q.lo[row] = q.hi[row] = 0;
      continue;
    }
    f.first -= f.first > gone, f.normal -= f.normal > gone;
    q.friction.push_back(f);
  }
  return q;
}

double digits(double value, int bits) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(mantissa, bits)), exponent - bits);
}

}  // namespace

Lcp shrink(Lcp problem, const std::function<bool(const Lcp&)>& shows) {
  const auto take = [&](Lcp candidate) {
    if (!shows(candidate)) return false;
    problem = std::move(candidate);
    return true;
  };
  if (!std::holds_alternative<DenseMatrix>(problem.A)) {
    Lcp dense = problem;
    DenseMatrix A;
    to_dense(problem.A, A);
    dense.A = A;
    if (!take(std::move(dense))) return problem;
  }
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (Index i = problem.size(); i-- > 0 && problem.size() > 1;)
      if (i < problem.size()) smaller = take(without(problem, i)) || smaller;
    const auto simplify = [&](auto&& entry) {  // entry(lcp) → double&
      const double now = entry(problem);
      for (const double value : {0.0, 1.0, -1.0, digits(now, 1), digits(now, 4), digits(now, 12), digits(now, 30)}) {
        if (value == now) return;
        if (std::isinf(now) || !std::isfinite(value)) return;
        Lcp candidate = problem;
        entry(candidate) = value;
        if (take(std::move(candidate))) {
          smaller = true;
          return;
        }
      }
    };
    for (Index i = 0; i < problem.size(); ++i) {
      for (Index j = 0; j < problem.size(); ++j)
        simplify([i, j](Lcp& p) -> double& { return std::get<DenseMatrix>(p.A)(i, j); });
      simplify([i](Lcp& p) -> double& { return p.b[i]; });
    }
    for (Index i = 0; i < problem.size(); ++i) {
      if (problem.lo[i] == 0 && problem.hi[i] == kInf) continue;
      Lcp candidate = problem;
      std::erase_if(candidate.friction, [i](const Friction& f) { return f.first <= i && i < f.first + f.rows; });
      candidate.lo[i] = 0, candidate.hi[i] = kInf;
      smaller = take(std::move(candidate)) || smaller;
    }
  }
  return problem;
}

}  // namespace orthant

#include <orthant/solvers/at_bounds.h>

#include <orthant/core/lcp/judge/certify_sums.h>

#include <algorithm>
#include <cmath>

namespace orthant {

bool AtBounds::put(const Lcp& problem, const Solution& s, Vector& to) {
  if (problem.discs()) return false;
  const Index n = problem.size();
  diagonal(problem.A, stiff_);
  detail::sum_rows(problem.A, problem.b, s.z, w_, size_, inner_, inner_size_);
  if (n > 0 && !(stiff_.minCoeff() > 0)) {
    detail::largest_of_columns(problem.A, widest_);
    for (Index i = 0; i < n; ++i)
      if (!(stiff_[i] > 0)) stiff_[i] = widest_[i];
  }
  to.resize(n);
  to = s.z;
  bool moved = false;
  const auto put = [&](Index i, double lo, double hi) {
    double& z = to[i];
    const double w = s.w[i], before = z;
    const auto near = [&](double way, double pull) {
      return stiff_[i] * way < pull || stiff_[i] * way <= detail::kEpsilon * size_[i];
    };
    if (z < lo || (z - lo <= hi - z && near(z - lo, w)) || stiff_[i] * (z - lo) < w) z = lo;
    if (z > hi || (hi - z < z - lo && near(hi - z, -w)) || stiff_[i] * (hi - z) < -w) z = hi;
    moved = moved || z != before;
  };
  for (Index i = 0; i < n; ++i)
    if (problem.lo[i] > -kInf || problem.hi[i] < kInf) put(i, problem.lo[i], problem.hi[i]);
  for (const Friction& f : problem.friction) {
    const double bound = f.mu * std::max(to[f.normal], 0.0), before = f.mu * std::max(s.z[f.normal], 0.0);
    if (before != bound && std::abs(to[f.first]) == before)  // what was at its bound goes with it
      to[f.first] = std::copysign(bound, to[f.first]), moved = true;
    put(f.first, -bound, bound);
  }
  return moved;
}

}  // namespace orthant

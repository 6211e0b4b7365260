#include <orthant/solvers/at_bounds.h>

#include <orthant/core/lcp/judge/certify_sums.h>

#include <algorithm>
#include <cmath>

namespace orthant {

bool put_at_bounds(const Lcp& problem, const Solution& s, Vector& widest, Vector& to) {
  const Index n = problem.size();
  detail::largest_of_columns(problem.A, widest);
  to.resize(n);
  to = s.z;
  bool moved = false;
  const auto put = [&](Index i, double lo, double hi) {
    double& z = to[i];
    const double w = s.w[i], before = z;
    const auto near = [&](double way, double pull) { return widest[i] * way < pull || widest[i] * way <= s.rounding; };
    if (z < lo || (z - lo <= hi - z && near(z - lo, w)) || widest[i] * (z - lo) < w) z = lo;
    if (z > hi || (hi - z < z - lo && near(hi - z, -w)) || widest[i] * (hi - z) < -w) z = hi;
    moved = moved || z != before;
  };
  for (Index i = 0; i < n; ++i)
    if (problem.lo[i] > -kInf || problem.hi[i] < kInf) put(i, problem.lo[i], problem.hi[i]);
  for (const Friction& f : problem.friction) {
    const double bound = f.mu * std::max(to[f.normal], 0.0), before = f.mu * std::max(s.z[f.normal], 0.0);
    if (before != bound && std::abs(to[f.row]) == before)  // what was at its bound goes with it
      to[f.row] = std::copysign(bound, to[f.row]), moved = true;
    put(f.row, -bound, bound);
  }
  return moved;
}

}  // namespace orthant

#include <orthant/solvers/murty.h>

namespace orthant {

std::string Murty::why_not(const Lcp& problem) const {
  return problem.friction.empty() ? "" : "friction rows: the method needs bounds that do not depend on z";
}

Status Murty::run(const Lcp& problem, Solution& s, Start) {
  if (problem.size() == 0) return Status::solved;
  const Index n = problem.size();
  rows_.load(problem, s.z);
  for (Index i = 0; i < n; ++i)
    rows_.side[static_cast<std::size_t>(i)] = problem.lo[i] != -kInf  ? Side::lower
                                              : problem.hi[i] != kInf ? Side::upper
                                                                      : Side::inside;
  for (;;) {
    if (!rows_.solve()) return Status::stalled;
    s.z = rows_.z.cwiseMax(problem.lo).cwiseMin(problem.hi);
    Index i = 0;
    while (i < n && rows_.better(i) == rows_.side[static_cast<std::size_t>(i)]) ++i;
    log(s.iterations, static_cast<double>(i));
    if (i == n) return Status::solved;
    if (s.iterations >= options_.max_pivots) return Status::iteration_limit;
    if (budget().exhausted()) return Status::time_limit;
    rows_.side[static_cast<std::size_t>(i)] = rows_.better(i);
    ++s.iterations;
  }
}

}  // namespace orthant

#include <orthant/solvers/active_set/block_pivot.h>

#include <algorithm>

namespace orthant {

namespace {
constexpr Index kFewWrong = 2;  // rows that rounding may have turned
}

std::string BlockPivot::why_not(const Lcp& problem) const {
  return problem.friction.empty() ? "" : "friction rows: the method needs bounds that do not depend on z";
}

Claim BlockPivot::run(const Lcp& problem, Solution& s, Start start) {
  if (problem.size() == 0) return Claim::candidate;
  const Index n = problem.size();
  const bool guessed = start == Start::warm || (options_.coarse_start == 1 && coarse_.guess(problem, budget(), s.z));
  rows_.load(problem, s.z, budget());
  if (!guessed && !rows_.release_all(false)) rows_.load(problem, s.z, budget());
  Index least = n + 1;
  int patience = options_.patience;
  while (s.iterations < options_.max_iterations) {
    ++s.iterations;
    const bool refined = patience == 0;
    if (!rows_.solve(refined)) return Claim::stalled;
    Index wrong = 0, last = -1;
    const auto count = [&] {
      wrong = 0, last = -1;
      for (Index i = 0; i < n; ++i)
        if (rows_.better(i) != rows_.side[static_cast<std::size_t>(i)]) ++wrong, last = i;
    };
    count();
    if (!refined && wrong <= kFewWrong) {
      if (!rows_.refine()) return Claim::stalled;
      count();
    }
    log(s.iterations, static_cast<double>(wrong), 0, patience > 0 ? "block" : "single");
    s.z = rows_.z.cwiseMax(problem.lo).cwiseMin(problem.hi);
    if (wrong == 0) return Claim::candidate;
    if (budget().exhausted()) return Claim::time_limit;
    if (wrong < least)
      least = wrong, patience = options_.patience;
    else
      patience = std::max(0, patience - 1);
    for (Index i = patience > 0 || wrong == 1 ? 0 : last; i <= last; ++i)
      rows_.side[static_cast<std::size_t>(i)] = rows_.better(i);
  }
  return Claim::iteration_limit;
}

}  // namespace orthant

// experiments/sweep/run.h — sweep runner and its resumption after a kill: runs the missing cases, each in a separate
// process, into the results file.
//
//   Cases that are compared with other runs wait for those. Timed ones come last, one at a time. A case that crashes or
//   does not end is a row with that status. Several programs may run the same sweep into the same file: each case is
//   done by one of them, and they end when all are done.
#pragma once

#include "experiments/sweep/results.h"

namespace orthant {

/// How many of the sweep's cases were run here, and how many of those were not solved.
struct Tally {
  int run = 0, failed = 0;
};

/// `jobs` 0: one a core. Forks: no other threads. `retry`: cases that a time limit or a crash ended are run again
/// (results.h).
Tally run_sweep(const Sweep& sweep, Results& results, const std::filesystem::path& file, unsigned jobs,
                bool retry = false);

/// One case in a process of its own, and so the run that it is compared with, which comes first: the rows that a sweep
/// would have written.
std::vector<ResultRow> run_apart(const Case& c);

}  // namespace orthant

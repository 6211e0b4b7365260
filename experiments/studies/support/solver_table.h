// Table of solvers and rivals on cases: problems solved, and times; each in a process of its own with a time limit;
// residuals are recomputed by a second judge, and failures are rows too.
#pragma once

#include "experiments/studies/support/lcp_cases.h"
#include "experiments/studies/support/lcp_trial.h"
#include "experiments/studies/support/rivals.h"

#include <functional>

namespace orthant {

struct SolverTable {
  struct Row {
    std::size_t problem = 0, solver = 0;  // places below
    Trial trial;
    Result result = Result::skipped;
  };
  struct Problem {
    LcpCase about;
    std::string group;
    Index n = 0;
    double scale = 1;       // 1 + ‖b‖∞
    double best = kInf;     // fastest certified [s]
    bool solvable = false;  // somebody's solution was accepted
  };
  using Cells = std::vector<std::vector<std::string>>;  // rows of cells, the first the titles

  std::vector<std::string> solvers;  // rivals last
  std::vector<Problem> problems;
  std::vector<Row> rows;

  std::string csv() const;  // a line per row
  std::string paths_csv()
      const;              // what really answered: a method that hands a problem on, or has shortcuts, is seen here
  Cells summary() const;  // a line per solver
  /// A line per problem that somebody solved: the fastest solver, its time, that of `solver`, and their ratio; the
  /// largest first, before it those that `solver` does not certify (empty cells).
  Cells regret(const std::string& solver) const;
};

struct TrialLimits {
  double time = 2;    // of a solve [s]; killed after 1.5 times that
  double memory = 4;  // [GB]; 0: no limit
  unsigned jobs = 1;  // processes at a time
};

/// Every solver (NAME[:option=value,…]) and rival on every case; `save` gets what there is every minute.
SolverTable try_all(std::vector<std::string> solvers, const std::vector<Rival>& rivals,
                    const std::vector<LcpCase>& cases, const TrialLimits& limits,
                    const std::function<void(const SolverTable&)>& save);

std::string to_csv(const SolverTable::Cells& cells);

}  // namespace orthant

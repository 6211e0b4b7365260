// solvers/factorization_count.h — counts of matrix factorizations, taken where they are made.
//
//   Every factorization of a method of this library adds to its thread's tally: one, and its rows (those of a basis
//   without its unit columns). Solver::solve() takes the difference into the solution, those of solvers it calls
//   included. Inside Ipopt and NLopt nothing is counted.
#pragma once

#include <orthant/core/lcp/problem.h>

namespace orthant {

struct FactorizationCount {
  long factorizations = 0;
  double rows = 0;   // factorized, in all
  double cubes = 0;  // Σ rows³: what dense factorizations cost goes by it
};

inline FactorizationCount& factorization_count() {  // of this thread, since it began
  static thread_local FactorizationCount tally;
  return tally;
}

inline void count_factorization(Index rows) {
  ++factorization_count().factorizations;
  const auto m = static_cast<double>(rows);
  factorization_count().rows += m;
  factorization_count().cubes += m * m * m;
}

}  // namespace orthant

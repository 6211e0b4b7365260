// solvers/effort.h — counts of matrix factorizations, taken where they are made.
//
//   Every factorization of a method of this library adds to its thread's tally: one, and its rows (those of a basis
//   without its unit columns). Solver::solve() takes the difference into the solution, those of solvers it calls
//   included. Inside Ipopt and NLopt nothing is counted.
#pragma once

#include <orthant/core/lcp/problem.h>

namespace orthant {

struct Effort {
  long factorizations = 0;
  double rows = 0;   // factorized, in all
  double cubes = 0;  // Σ rows³: what dense factorizations cost goes by it
};

inline Effort& effort() {  // of this thread, since it began
  static thread_local Effort tally;
  return tally;
}

inline void count_factorization(Index rows) {
  ++effort().factorizations;
  const auto m = static_cast<double>(rows);
  effort().rows += m;
  effort().cubes += m * m * m;
}

}  // namespace orthant

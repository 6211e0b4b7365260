// solvers/linear_algebra/sparse_budget.h — time limits of sparse factorizations: order, analyse and factorize only
// where the prediction says that the time left suffices.
//
//   Neither step can be interrupted. A refusal ends the budget, so that the solver says time_limit.
#pragma once

#include <orthant/core/support/factorization_cost.h>
#include <orthant/core/support/ordering_cost.h>
#include <orthant/solvers/budget.h>

namespace orthant {

/// UMFPACK's analysis takes 3 to 15 times as long as AMD alone.
inline constexpr double kUmfpackOrderings = 6;

/// Whether there is time for so many orderings of n × n compressed columns (or rows). budget null or without a limit:
/// yes, at no cost.
inline bool affords_ordering(const Budget* budget, int n, const int* start, const int* index, double orderings = 1) {
  return budget == nullptr || !budget->timed() || budget->affords(orderings * ordering_cost(n, start, index));
}

/// Whether there is time for the orderings and for the LU factorization after them, likewise.
inline bool affords_factorization(const Budget* budget, int n, const int* start, const int* index, double orderings) {
  return budget == nullptr || !budget->timed() ||
         (affords_ordering(budget, n, start, index, orderings + 1) &&  // one is factorization_cost()'s
          budget->affords(factorization_cost(n, start, index)));
}

}  // namespace orthant

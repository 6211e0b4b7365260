// experiments/sweep/analysis.h — analysis of a sweep: orders of convergence, the time that an error takes.
#pragma once

#include "experiments/sweep/case.h"

#include <orthant/core/lcp/problem.h>

namespace orthant {

inline std::string row_text(const ResultRow& row, const char* column) { return row.at(column).get<std::string>(); }
/// Infinite where there is none.
inline double row_number(const ResultRow& row, const char* column) {
  return row.at(column).is_null() ? kInf : row.at(column).get<double>();
}
inline bool row_solved(const ResultRow& row) { return row.at("status") == "solved"; }

/// Worst error of each octave of h, and the slope of its logarithm (support/fit_order.h), but errors
/// that rounding may have made, below 1e-13 of the measure itself, are left out: a group for every integrator,
/// solver and set of parameters with errors in two octaves at least. Keys: integrator, solver, parameters, order,
/// scatter, failed, worst ([h, error] by octave).
nlohmann::ordered_json fitted_orders(const std::vector<ResultRow>& rows);

/// Processor time to errors of 1e-2 … 1e-9: for each integrator and solver that has timed rows, and each set of
/// parameters, the cheapest timed setting from which on every finer timed one is as good; the worst over the sets of
/// parameters in which anybody gets there, null where one of them is not reached. Keys: integrator, solver, seconds (by
/// target).
nlohmann::ordered_json time_to_error(const std::vector<ResultRow>& rows);
std::span<const double> error_targets();

/// Convergence of a run's statistics against the run of the same parameters by the integrator that the sweep
/// compares with. For each set of parameters with such a run and each statistic the greatest order that any
/// method shows over the three finest octaves of h. Keys: parameters, statistic, order, integrator.
nlohmann::ordered_json orders_of_statistics(const std::vector<ResultRow>& rows);

/// Below this order an error does not fall to speak of.
inline constexpr double kNoOrder = 0.5;

/// Two sentences, computed from the rows: failures and orders; the cheapest method at an error, what it keeps.
std::string answer(const std::vector<ResultRow>& rows);

}  // namespace orthant

// experiments/sweep/analysis.h — what rows of a sweep say: orders of convergence, the time that an error takes.
#pragma once

#include "case.h"

#include <orthant/core/lcp/problem.h>

namespace orthant {

/// Worst error of each octave of h, and the slope of its logarithm (support/fit_order.h): a group for every integrator,
/// solver and set of parameters with errors in two octaves at least. Keys: integrator, solver, parameters, order, scatter,
/// failed, worst ([h, error] by octave).
nlohmann::ordered_json fitted_orders(const std::vector<ResultRow>& rows);

/// Processor time to errors of 1e-2 … 1e-9: for each integrator and solver that has timed rows, and each set of parameters, the
/// cheapest setting from which on every finer one is as good (no lucky run counts); the worst over the sets of parameters
/// in which anybody gets there, null where one of them is not reached. Keys: integrator, solver, seconds (by target).
nlohmann::ordered_json time_to_error(const std::vector<ResultRow>& rows);
std::span<const double> error_targets();

/// Two sentences, computed from the rows.
std::string answer(const std::vector<ResultRow>& rows);

}  // namespace orthant

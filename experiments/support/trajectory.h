// experiments/support/trajectory.h — a run as a table: one column list for CSV files, summaries and plots.
#pragma once

#include <orthant/integrators/simulate.h>

#include <string>
#include <vector>

namespace orthant {

/// t, then x, y, theta, vx, vy, omega of each body, then gap, impulse_n, impulse_t of each contact (impulses summed
/// since the row before), then energy, joint_residual, penetration, lcp_residual, lcp_iterations of the step. SI units.
std::vector<std::string> trajectory_columns(const Scene& scene);

/// Appends one row in that order.
void append_row(const System& system, const Moment& moment, std::vector<double>& table);

/// The table as CSV text, numbers in their shortest exact form.
std::string to_csv(const std::vector<std::string>& columns, const std::vector<double>& table);

}  // namespace orthant

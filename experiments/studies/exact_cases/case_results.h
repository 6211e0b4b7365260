// experiments/studies/exact_cases/case_results.h — results of runs of exact cases, and their tables.
#pragma once

#include "experiments/studies/exact_cases/exact_case.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

/// One run of a case.
struct CaseRow {
  std::size_t exact_case = 0;
  std::string integrator, solver;
  double setting = 0;
  std::string status, why;
  double error = kInf, seconds = kInf;
  double lcp_solves = 0, lcp_iterations = 0, residual = 0, penetration = 0, joint_residual = 0, energy_defect = 0;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CaseRow, exact_case, integrator, solver, setting, status, why, error, seconds,
                                   lcp_solves, lcp_iterations, residual, penetration, joint_residual, energy_defect)

/// Whether the integrator follows a tolerance, or else steps of fixed size.
inline bool by_tolerance(std::string_view integrator) {
  return integrator == "adaptive" || integrator == "event-driven";
}

/// Writes runs.csv, a line a run, and table.md, a line for the solvers that agree on a case, and prints the table. The
/// rows of a case, an integrator and a solver follow each other, coarse to fine.
void report(const std::filesystem::path& output, const std::vector<ExactCase>& all, const std::vector<CaseRow>& rows);

}  // namespace orthant

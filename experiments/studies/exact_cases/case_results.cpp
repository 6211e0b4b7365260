#include "experiments/studies/exact_cases/case_results.h"

#include "experiments/support/fit_order.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>

namespace orthant {
namespace {

/// The runs of one integrator with one solver on one case, coarse to fine.
struct Series {
  std::vector<const CaseRow*> rows;
  /// By the worst error of each octave; not a number where errors are 0, infinite or too few.
  double order() const {
    std::vector<Sample> samples;
    for (const CaseRow* r : rows)
      if (r->error > 1e-13 && r->error < kInf) samples.push_back({r->setting, r->error});
    try {
      return fit_order(samples).order;
    } catch (const std::invalid_argument&) {
      return std::nan("");
    }
  }
  /// Of the last octave, the worst.
  double finest_error() const {
    double worst = 0;
    for (const CaseRow* r : rows)
      if (r == rows.back() || (!by_tolerance(r->integrator) && r->setting < 1.9 * rows.back()->setting))
        worst = std::max(worst, r->error);
    return worst;
  }
};

double expected_order(const ExactCase& exact_case, const std::string& integrator) {
  if (exact_case.motion != ExactCase::Motion::smooth) return 1;
  return integrator == "moreau-jean" || integrator == "rattle" || integrator == "generalized-alpha" ? 2 : 1;
}

std::string verdict(const ExactCase& exact_case, const Series& series) {
  if (const CaseRow& r = *series.rows.front();
      !exact_case.word.empty() && r.why.find(exact_case.word) != std::string::npos)
    return "pass";
  for (const CaseRow* r : series.rows)
    if (r->status != "solved")
      return r->status + " at " + detail::text_of(r->setting) + (r->why.empty() ? "" : ": " + r->why);
  const CaseRow& finest = *series.rows.back();
  if (series.finest_error() <= exact_case.exact) return "pass";
  if (by_tolerance(finest.integrator)) return finest.error <= 1e-6 ? "pass" : "error above 1e-6";
  if (exact_case.motion == ExactCase::Motion::instant) return "another answer";
  const double order = series.order(), wanted = expected_order(exact_case, finest.integrator) - 0.15;
  if (order >= wanted) return "pass";
  return "order below " + detail::text_of(wanted);
}

constexpr const char* kMotions[] = {"smooth", "events", "instant"};

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", x);
  return std::isfinite(x) ? text : "";
}

std::string csv_of(const std::vector<ExactCase>& all, const std::vector<CaseRow>& rows) {
  std::string csv =
      "case,title,motion,measure,integrator,solver,setting,status,error,seconds,lcp_solves,lcp_iterations,lcp_residual,"
      "penetration,"
      "joint_residual,energy_defect,why\n";
  const auto quoted = [](std::string text) {
    std::erase(text, '"');
    return '"' + text + '"';
  };
  for (const CaseRow& r : rows) {
    const ExactCase& exact_case = all[r.exact_case];
    csv += exact_case.id + ',' + quoted(exact_case.title) + ',' + kMotions[static_cast<int>(exact_case.motion)] + ',' +
           quoted(exact_case.measure) + ',' + r.integrator + ',' + quoted(r.solver) + ',' + detail::text_of(r.setting) +
           ',' + r.status;
    for (const double x : {r.error, r.seconds, r.lcp_solves, r.lcp_iterations, r.residual, r.penetration,
                           r.joint_residual, r.energy_defect})
      csv += ',' + (std::isfinite(x) ? detail::text_of(x) : "");
    csv += ',' + quoted(r.why) + '\n';
  }
  return csv;
}

/// One function: the lines of the table and, at its end, the counts of all.
std::string table_of(const std::vector<ExactCase>& all, const std::vector<CaseRow>& rows) {
  std::string table =
      "| case | integrator | solvers | coarsest | finest error | order | ms | residual | penetration | joints | energy "
      "| |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::map<std::string, std::map<std::string, std::pair<int, int>>> tally;  // passed, all: by integrator, by solver
  std::vector<std::string> columns;
  for (std::size_t k = 0; k < rows.size();) {
    // One line for all solvers that agree to rounding.
    std::vector<std::pair<std::string, Series>> by_solver;
    const std::size_t first = k;
    for (; k < rows.size() && rows[k].exact_case == rows[first].exact_case &&
           rows[k].integrator == rows[first].integrator;
         ++k) {
      if (by_solver.empty() || by_solver.back().first != rows[k].solver) by_solver.push_back({rows[k].solver, {}});
      by_solver.back().second.rows.push_back(&rows[k]);
    }
    const ExactCase& exact_case = all[rows[first].exact_case];
    const auto same = [](const Series& a, const Series& b) {
      for (std::size_t i = 0; i < a.rows.size(); ++i)
        if (a.rows[i]->status != b.rows[i]->status ||
            !(std::abs(a.rows[i]->error - b.rows[i]->error) <= 1e-3 * a.rows[i]->error + 1e-12))
          return false;
      return true;
    };
    std::vector<bool> named(by_solver.size());
    for (std::size_t i = 0; i < by_solver.size(); ++i) {
      const std::string& solver = by_solver[i].first;
      const std::string column = !exact_case.has_contacts() ? "no contacts"
                                 : exact_case.pyramids      ? "pyramids"
                                                            : solver.substr(0, solver.find(':'));
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
      auto& [passed, run] = tally[rows[first].integrator][column];
      ++run, passed += verdict(exact_case, by_solver[i].second) == "pass";
      if (named[i]) continue;
      std::string names;
      for (std::size_t j = i; j < by_solver.size(); ++j) {
        if (named[j] || (j > i && !same(by_solver[i].second, by_solver[j].second))) continue;
        named[j] = true;
        names += (names.empty() ? "" : " ") + by_solver[j].first;
      }
      if (!exact_case.has_contacts()) names = "(none)";
      const Series& series = by_solver[i].second;
      const CaseRow &coarse = *series.rows.front(), &fine = *series.rows.back();
      const auto worst = [&](double CaseRow::*field) {
        double most = 0;
        for (const CaseRow* r : series.rows) most = std::max(most, r->*field);
        return number(most);
      };
      table += "| " + exact_case.id + " " + exact_case.title + " | `" + fine.integrator + "` | " + names + " | " +
               number(coarse.error) + " | " + number(fine.error) + " | " +
               (by_tolerance(fine.integrator) ? "" : number(series.order())) + " | " + number(1e3 * fine.seconds) +
               " | " + worst(&CaseRow::residual) + " | " + worst(&CaseRow::penetration) + " | " +
               worst(&CaseRow::joint_residual) + " | " +
               (exact_case.energy == ExactCase::Energy::driven ? "" : worst(&CaseRow::energy_defect)) + " | " +
               verdict(exact_case, series) + " |\n";
    }
  }
  table += "\nPassed:\n\n| integrator |";
  for (const std::string& column : columns) table += ' ' + column + " |";
  table += "\n|---|";
  for (std::size_t i = 0; i < columns.size(); ++i) table += "---|";
  for (const IntegratorEntry& entry : integrators()) {
    table += "\n| `" + std::string(entry.name) + "` |";
    for (const std::string& column : columns) {
      const auto [passed, run] = tally[std::string(entry.name)][column];
      table += ' ' + std::to_string(passed) + " of " + std::to_string(run) + " |";
    }
  }
  return table + '\n';
}

}  // namespace

void report(const std::filesystem::path& output, const std::vector<ExactCase>& all, const std::vector<CaseRow>& rows) {
  write_whole(output / "runs.csv", csv_of(all, rows));
  const std::string table = table_of(all, rows);
  write_whole(output / "table.md", table);
  std::cout << table;
}

}  // namespace orthant

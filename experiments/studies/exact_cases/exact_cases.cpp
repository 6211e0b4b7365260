// Hard cases with exact answers: every case by every integrator with several solvers, compared with its exact answer.
//
// Schemes of fixed step run at h, h/2, … (four steps an octave where events make the error a sawtooth); the order is
// that of the worst error of each octave (fit_order.h). `adaptive` and `event-driven` run over tolerances instead. Each
// run is a process of its own, under a time limit, so that a crash or an endless loop is a row as well. An answer
// passes
//   when its error is at most the `exact` of the case, or
//   fixed step  when it converges: order ≥ 0.85 with events, ≥ 1.85 or 0.85 (by scheme) without;
//   tolerances  when the finest error is at most 1e-6.
// Nothing is left out: a case that does not pass says why.
#include "experiments/runs/manifest.h"
#include "experiments/studies/exact_cases/exact_case.h"
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/fit_order.h"
#include "experiments/support/isolated.h"
#include "experiments/support/progress.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>
#include <map>
#include <thread>

using namespace orthant;

namespace {

struct Setting {
  double value = 0;  // step size [s], or tolerance
  std::string spec;  // of the integrator
  double step = 0;   // of the calls [s]
};

struct Row {
  std::size_t exact_case = 0;
  std::string integrator, solver;
  double setting = 0;
  std::string status, why;
  double error = kInf, seconds = kInf;
  double lcp_solves = 0, lcp_iterations = 0, residual = 0, penetration = 0, joint_residual = 0, energy_defect = 0;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Row, exact_case, integrator, solver, setting, status, why, error, seconds,
                                   lcp_solves, lcp_iterations, residual, penetration, joint_residual, energy_defect)

bool by_tolerance(std::string_view integrator) { return integrator == "adaptive" || integrator == "event-driven"; }

constexpr int kStepsPerOctave = 4;  // where events make the error a sawtooth in h

std::vector<Setting> ladder(const ExactCase& exact_case, const std::string& integrator, int levels) {
  std::vector<Setting> settings;
  if (exact_case.motion == ExactCase::Motion::instant) levels = 1;
  if (exact_case.motion == ExactCase::Motion::events && !by_tolerance(integrator)) {
    for (const double h : step_sizes({exact_case.h, levels, kStepsPerOctave, exact_case.duration}))
      settings.push_back({h, integrator, h});
    return settings;
  }
  for (int k = 0; k < levels; ++k) {
    if (by_tolerance(integrator)) {
      const double tolerance = std::pow(10.0, levels == 1 ? -8 : -3 - 6.0 * k / (levels - 1));
      const std::string spec =
          integrator + ":rtol=" + detail::text_of(tolerance) + ",atol=" + detail::text_of(tolerance / 1000);
      settings.push_back({tolerance, spec, exact_case.duration / 100});
    } else {
      const double h = exact_case.h / std::pow(2, k);
      settings.push_back({h, integrator, h});
    }
  }
  return settings;
}

/// What the energy does that it must not [J]: leaves its first value, or rises.
template <class Space> class EnergyDefect {
 public:
  EnergyDefect(const SystemOf<Space>& system, ExactCase::Energy kind) : system_(system), kind_(kind) {}
  void see(const State& x) {
    if (kind_ == ExactCase::Energy::driven) return;
    const double e = energy(system_, x);
    if (!seen_) least_ = e;
    defect_ = std::max(defect_, kind_ == ExactCase::Energy::conserved ? std::abs(e - least_) : e - least_);
    if (kind_ == ExactCase::Energy::falls) least_ = std::min(least_, e);
    seen_ = true;
  }
  double value() const { return defect_; }

 private:
  const SystemOf<Space>& system_;
  ExactCase::Energy kind_;
  double least_ = 0, defect_ = 0;
  bool seen_ = false;
};

/// Bisects until the bracket is a tenth of `exact`; the worst of the runs' reports, the sums of their work.
Row bisect(const ExactCase& exact_case, const std::string& solver, const Setting& setting);

/// One run; `error` of each recorded moment.
template <class Space, class Error> Row run_of(const ExactCase& exact_case, const SystemOf<Space>& system,
                                               const std::string& solver, const Setting& setting, Error&& error) {
  const auto scheme = make_integrator(setting.spec, system);
  const auto lcp = make_solver(solver);
  EnergyDefect<Space> defect(system, exact_case.energy);
  double last = 0;
  const Run run = simulate(*scheme, *lcp, {.step = setting.step, .duration = exact_case.duration},
                           [&](const RunSampleOf<Space>& m) {
                             const double now = error(m);
                             last = exact_case.throughout ? std::max(last, now) : now;
                             defect.see(m.state);
                           });
  Row row;
  row.status = name(run.status), row.why = run.why;
  row.seconds = run.seconds;
  if (run.status == Status::solved) row.error = last;
  row.lcp_solves = static_cast<double>(run.lcp_solves), row.lcp_iterations = static_cast<double>(run.lcp_iterations);
  row.residual = run.max_lcp_residual, row.penetration = run.max_penetration;
  row.joint_residual = run.max_joint_residual, row.energy_defect = defect.value();
  return row;
}

Row visit(const ExactCase& exact_case, const std::string& solver, const Setting& setting) {
  if (exact_case.family) return bisect(exact_case, solver, setting);
  if (exact_case.in_space()) {
    const SystemOf<Spatial> system(std::get<spatial::Scene>(exact_case.scene));
    return run_of(exact_case, system, solver, setting,
                  [&](const RunSampleOf<Spatial>& m) { return exact_case.error_in_space(system, m.state); });
  }
  const System system(std::get<Scene>(exact_case.scene));
  auto error = exact_case.error;
  if (exact_case.original) {
    const System other(*exact_case.original);
    const Run twin = simulate(*make_integrator(setting.spec, other),
                              *make_solver(exact_case.rival.empty() ? solver : exact_case.rival),
                              {.step = setting.step, .duration = exact_case.duration});
    if (twin.status == Status::solved)
      error = [&, end = twin.final](const RunSample& m) { return exact_case.unlike(m.state, end); };
    else
      error = [](const RunSample&) { return kInf; };
  }
  return run_of(exact_case, system, solver, setting, error);
}

Row bisect(const ExactCase& exact_case, const std::string& solver, const Setting& setting) {
  ExactCase probe = exact_case;
  probe.family = nullptr;
  double low = exact_case.low, high = exact_case.high;
  Row all;
  all.seconds = all.error = 0;
  const auto holds = [&](double parameter) {
    probe.scene = exact_case.family(parameter);
    const Row row = visit(probe, solver, setting);
    all.status = row.status, all.why = row.why;
    all.seconds += row.seconds, all.lcp_solves += row.lcp_solves, all.lcp_iterations += row.lcp_iterations;
    for (double Row::*most : {&Row::residual, &Row::penetration, &Row::joint_residual, &Row::energy_defect})
      all.*most = std::max(all.*most, row.*most);
    return row.error <= 0.5;
  };
  const bool falls = !holds(low);
  if (all.status != "solved" || !falls || !holds(high) || all.status != "solved") {
    all.error = kInf;  // the two ends cannot be distinguished
    return all;
  }
  while (high - low > 0.1 * exact_case.exact * exact_case.threshold) {
    const double middle = (low + high) / 2;
    (holds(middle) ? high : low) = middle;
    if (all.status != "solved") return all;
  }
  all.error =
      std::max(std::abs(low - exact_case.threshold), std::abs(high - exact_case.threshold)) / exact_case.threshold;
  return all;
}

struct Plan {
  std::vector<std::string> solvers, only;
  int levels = 6;
  double time_limit = 20;
  unsigned jobs = 1;
};

std::vector<Row> visit_all(const Plan& plan, const std::vector<ExactCase>& all) {
  struct Ticket {
    std::size_t exact_case;
    std::string integrator, solver;
    Setting setting;
  };
  std::vector<Ticket> tickets;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const IntegratorEntry& entry : integrators()) {
      if (!all[i].integrator.empty() && entry.name != all[i].integrator) continue;
      if (all[i].in_space() && !entry.can.space) continue;
      std::vector<std::string> solvers = plan.solvers;
      if (!all[i].has_contacts()) solvers.resize(1);  // there is nothing to solve
      if (!all[i].solvers.empty()) solvers = all[i].solvers;
      for (const std::string& solver : solvers)
        for (const Setting& setting : ladder(all[i], std::string(entry.name), plan.levels))
          tickets.push_back({i, std::string(entry.name), solver, setting});
    }
  std::vector<Row> rows(tickets.size());
  Progress progress("exact_cases", static_cast<double>(tickets.size()));
  Isolated processes(plan.jobs, 0);  // no limit of memory: sanitizers take terabytes of addresses
  for (std::size_t k = 0; k < tickets.size(); ++k) {
    const Ticket& t = tickets[k];
    processes.start(
        [&] { return nlohmann::json(visit(all[t.exact_case], t.solver, t.setting)).dump(); }, plan.time_limit,
        [&rows, &progress, &tickets, k](const Outcome& outcome) {
          const Ticket& ticket = tickets[k];
          Row& row = rows[k];
          if (outcome.kind == Outcome::finished) {
            // JSON has no infinity: null there
            auto json = nlohmann::json::parse(outcome.text);
            for (auto& [key, value] : json.items())
              if (value.is_null()) value = std::numeric_limits<double>::max();
            row = json.get<Row>();
            if (row.error == std::numeric_limits<double>::max()) row.error = kInf;
          } else {
            row.status = outcome.kind == Outcome::killed ? "out of time" : "crashed";
            row.why = outcome.text;
          }
          row.exact_case = ticket.exact_case, row.integrator = ticket.integrator, row.solver = ticket.solver;
          row.setting = ticket.setting.value;
          progress.add(1, row.status != "solved");
        });
  }
  processes.wait_for_all();
  return rows;
}

/// The runs of one integrator with one solver on one case, coarse to fine.
struct Series {
  std::vector<const Row*> rows;
  /// By the worst error of each octave; not a number where errors are 0, infinite or too few.
  double order() const {
    std::vector<Sample> samples;
    for (const Row* r : rows)
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
    for (const Row* r : rows)
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
  if (const Row& r = *series.rows.front(); !exact_case.word.empty() && r.why.find(exact_case.word) != std::string::npos)
    return "pass";
  for (const Row* r : series.rows)
    if (r->status != "solved")
      return r->status + " at " + detail::text_of(r->setting) + (r->why.empty() ? "" : ": " + r->why);
  const Row& finest = *series.rows.back();
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

/// One function: a pass over the rows for the CSV file, one over the series for the Markdown table.
void report(const std::filesystem::path& output, const std::vector<ExactCase>& all, const std::vector<Row>& rows) {
  std::string csv =
      "case,title,motion,measure,integrator,solver,setting,status,error,seconds,lcp_solves,lcp_iterations,lcp_residual,"
      "penetration,"
      "joint_residual,energy_defect,why\n";
  const auto quoted = [](std::string text) {
    std::erase(text, '"');
    return '"' + text + '"';
  };
  for (const Row& r : rows) {
    const ExactCase& exact_case = all[r.exact_case];
    csv += exact_case.id + ',' + quoted(exact_case.title) + ',' + kMotions[static_cast<int>(exact_case.motion)] + ',' +
           quoted(exact_case.measure) + ',' + r.integrator + ',' + quoted(r.solver) + ',' + detail::text_of(r.setting) +
           ',' + r.status;
    for (const double x : {r.error, r.seconds, r.lcp_solves, r.lcp_iterations, r.residual, r.penetration,
                           r.joint_residual, r.energy_defect})
      csv += ',' + (std::isfinite(x) ? detail::text_of(x) : "");
    csv += ',' + quoted(r.why) + '\n';
  }
  write_whole(output / "runs.csv", csv);

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
    std::vector<bool> told(by_solver.size());
    for (std::size_t i = 0; i < by_solver.size(); ++i) {
      const std::string& solver = by_solver[i].first;
      const std::string column = !exact_case.has_contacts() ? "no contacts" : solver.substr(0, solver.find(':'));
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
      auto& [passed, run] = tally[rows[first].integrator][column];
      ++run, passed += verdict(exact_case, by_solver[i].second) == "pass";
      if (told[i]) continue;
      std::string names;
      for (std::size_t j = i; j < by_solver.size(); ++j) {
        if (told[j] || (j > i && !same(by_solver[i].second, by_solver[j].second))) continue;
        told[j] = true;
        names += (names.empty() ? "" : " ") + by_solver[j].first;
      }
      if (!exact_case.has_contacts()) names = "(none)";
      const Series& series = by_solver[i].second;
      const Row &coarse = *series.rows.front(), &fine = *series.rows.back();
      const auto worst = [&](double Row::*field) {
        double most = 0;
        for (const Row* r : series.rows) most = std::max(most, r->*field);
        return number(most);
      };
      table += "| " + exact_case.id + " " + exact_case.title + " | `" + fine.integrator + "` | " + names + " | " +
               number(coarse.error) + " | " + number(fine.error) + " | " +
               (by_tolerance(fine.integrator) ? "" : number(series.order())) + " | " + number(1e3 * fine.seconds) +
               " | " + worst(&Row::residual) + " | " + worst(&Row::penetration) + " | " + worst(&Row::joint_residual) +
               " | " + (exact_case.energy == ExactCase::Energy::driven ? "" : worst(&Row::energy_defect)) + " | " +
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
  table += '\n';
  write_whole(output / "table.md", table);
  std::cout << table;
}

void run(const std::filesystem::path& output, const Plan& plan, int dimension, const std::string& command_line) {
  for (const std::string& solver : plan.solvers) make_solver(solver);  // bad names before hours of work
  std::vector<ExactCase> all = dimension == 2 ? exact_cases() : exact_cases_in_space();
  if (!plan.only.empty())
    std::erase_if(all, [&](const ExactCase& e) {
      return std::find(plan.only.begin(), plan.only.end(), e.id) == plan.only.end();
    });
  if (all.empty()) throw std::invalid_argument("--cases: no case has this number");
  std::filesystem::create_directories(output);
  check_writable(output / "runs.csv");
  report(output, all, visit_all(plan, all));
  auto about = manifest();
  about["command"] = command_line;
  write_whole(output / "manifest.json", about.dump(2) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path output = "results/exact_cases";
  Plan plan;
  int dimension = 2;
  bool quick = false;
  CLI::App app("Hard cases with exact answers: every case by every integrator, compared with its exact answer");
  app.add_option("--output", output, "folder for tables and manifest")->capture_default_str();
  app.add_option("--dimension", dimension, "2: cases in the plane, 3: in space")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  app.add_option(
      "--solvers", plan.solvers,
      "NAME[:option=value,...] ...; default: lemke path pgs newton-fb auto, in space auto prox pgs newton-ac");
  app.add_option("--cases", plan.only, "numbers of cases (B1 B13 ...); all when not given");
  app.add_option("--levels", plan.levels, "step sizes, each half of the one before")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  app.add_option("--time-limit", plan.time_limit, "of a run [s]")->check(between(0.1, 3600.0))->capture_default_str();
  app.add_option("--jobs", plan.jobs, "runs at a time")->check(CLI::Range(1, 256));
  app.add_flag("--quick", quick, "three step sizes, two seconds a run");
  plan.jobs = std::max(1U, std::thread::hardware_concurrency());
  if (const auto end = parse(app, argc, argv)) return *end;
  if (plan.solvers.empty() && dimension == 2) plan.solvers = {"lemke", "path", "pgs", "newton-fb", "auto"};
  if (plan.solvers.empty()) plan.solvers = {"auto", "prox", "pgs", "newton-ac"};
  if (quick) plan.levels = std::min(plan.levels, 3), plan.time_limit = std::min(plan.time_limit, 2.0);
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  try {
    run(output, plan, dimension, command_line);
  } catch (const std::exception& error) {
    std::cerr << "exact_cases: " << error.what() << '\n';
    return 1;
  }
}

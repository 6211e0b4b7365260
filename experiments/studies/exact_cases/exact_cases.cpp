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
#include "experiments/studies/exact_cases/case_results.h"
#include "experiments/studies/exact_cases/pyramid_paths.h"
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

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <thread>

using namespace orthant;

namespace {

struct Setting {
  double value = 0;  // step size [s], or tolerance
  std::string spec;  // of the integrator
  double step = 0;   // of the calls [s]
};

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
      const double finest =
          exact_case.in_space() && exact_case.has_contacts() && integrator == "event-driven" ? -13 : -9;
      const double tolerance = std::pow(10.0, levels == 1 ? -8 : -3 + (finest + 3) * k / (levels - 1));
      const std::string spec = integrator + ":rtol=" + detail::text_of(tolerance) +
                               ",atol=" + detail::text_of(std::max(tolerance / 1000, 1e-14));
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
CaseRow bisect(const ExactCase& exact_case, const std::string& solver, const Setting& setting);

/// One run; `error` of each recorded moment.
template <class Space, class Error> CaseRow run_of(const ExactCase& exact_case, const SystemOf<Space>& system,
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
  CaseRow row;
  row.status = name(run.status), row.why = run.why;
  row.seconds = run.seconds;
  if (run.status == Status::solved) row.error = last;
  row.lcp_solves = static_cast<double>(run.lcp_solves), row.lcp_iterations = static_cast<double>(run.lcp_iterations);
  row.residual = run.max_lcp_residual, row.penetration = run.max_penetration;
  row.joint_residual = run.max_joint_residual, row.energy_defect = defect.value();
  return row;
}

CaseRow visit(const ExactCase& exact_case, const std::string& solver, const Setting& setting) {
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

CaseRow bisect(const ExactCase& exact_case, const std::string& solver, const Setting& setting) {
  ExactCase probe = exact_case;
  probe.family = nullptr;
  double low = exact_case.low, high = exact_case.high;
  CaseRow all;
  all.seconds = all.error = 0;
  const auto holds = [&](double parameter) {
    probe.scene = exact_case.family(parameter);
    const CaseRow row = visit(probe, solver, setting);
    all.status = row.status, all.why = row.why;
    all.seconds += row.seconds, all.lcp_solves += row.lcp_solves, all.lcp_iterations += row.lcp_iterations;
    for (double CaseRow::*most :
         {&CaseRow::residual, &CaseRow::penetration, &CaseRow::joint_residual, &CaseRow::energy_defect})
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
  std::vector<std::string> solvers, only, integrators;  // empty: all
  int levels = 6;
  double time_limit = 20;
  unsigned jobs = 1;
};

std::vector<CaseRow> visit_all(const Plan& plan, const std::vector<ExactCase>& all) {
  struct Ticket {
    std::size_t exact_case;
    std::string integrator, solver;
    Setting setting;
  };
  std::vector<Ticket> tickets;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const IntegratorEntry& entry : integrators()) {
      if (!all[i].integrator.empty() && entry.name != all[i].integrator) continue;
      if (!plan.integrators.empty() && std::ranges::find(plan.integrators, entry.name) == plan.integrators.end())
        continue;
      if (all[i].in_space() && !entry.can.space) continue;
      if (all[i].pyramids && !entry.can.pyramids) continue;
      std::vector<std::string> solvers = plan.solvers;
      if (!all[i].has_contacts()) solvers.resize(1);  // there is nothing to solve
      if (!all[i].solvers.empty()) solvers = all[i].solvers;
      for (const std::string& solver : solvers)
        for (const Setting& setting : ladder(all[i], std::string(entry.name), plan.levels))
          tickets.push_back({i, std::string(entry.name), solver, setting});
    }
  std::vector<CaseRow> rows(tickets.size());
  Progress progress("exact_cases", static_cast<double>(tickets.size()));
  Isolated processes(plan.jobs, 0);  // no limit of memory: sanitizers take terabytes of addresses
  for (std::size_t k = 0; k < tickets.size(); ++k) {
    const Ticket& t = tickets[k];
    processes.start(
        [&] { return nlohmann::json(visit(all[t.exact_case], t.solver, t.setting)).dump(); }, plan.time_limit,
        [&rows, &progress, &tickets, k](const Outcome& outcome) {
          const Ticket& ticket = tickets[k];
          CaseRow& row = rows[k];
          if (outcome.kind == Outcome::finished) {
            // JSON has no infinity: null there
            auto json = nlohmann::json::parse(outcome.text);
            for (auto& [key, value] : json.items())
              if (value.is_null()) value = std::numeric_limits<double>::max();
            row = json.get<CaseRow>();
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

void run(const std::filesystem::path& output, const Plan& plan, int dimension, const std::string& command_line) {
  for (const std::string& solver : plan.solvers) make_solver(solver);  // bad names before hours of work
  for (const std::string& name : plan.integrators)
    if (std::ranges::none_of(integrators(), [&](const IntegratorEntry& entry) { return entry.name == name; }))
      throw std::invalid_argument("--integrators = " + name + ": must be names of integrators (orthant list)");
  std::vector<ExactCase> all = dimension == 2 ? exact_cases() : exact_cases_in_space();
  if (!plan.only.empty())
    std::erase_if(all, [&](const ExactCase& e) {
      return std::find(plan.only.begin(), plan.only.end(), e.id) == plan.only.end();
    });
  if (all.empty()) throw std::invalid_argument("--cases: no case has this number");
  std::filesystem::create_directories(output);
  check_writable(output / "runs.csv");
  report(output, all, visit_all(plan, all));
  if (std::ranges::any_of(all, &ExactCase::pyramids)) {
    const std::string paths = pyramid_paths();
    write_whole(output / "pyramids.md", paths);
    std::cout << paths;
  }
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
  app.add_option("--integrators", plan.integrators, "by these only; all when not given");
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

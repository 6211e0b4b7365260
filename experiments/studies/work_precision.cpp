// What does an error cost on the slider-crank, by every integrator?
//
// Each integrator, and whatever rivals there are (experiments/benchmarks), over a ladder of step sizes, or of
// tolerances, on μ × e; errors of θ₁(0.2 s) against the exact motion,
// the fastest of the repeats. "Time to ε" is that of the cheapest setting from which on every finer one stays below ε,
// so that no lucky run counts; the table shows the worst over the cases with e ≤ 0.4. Writes all runs and that table.
#include "experiments/runs/manifest.h"
#include "experiments/studies/support/rivals.h"
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/isolated.h"
#include "experiments/support/progress.h"

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>
#include <sstream>

using namespace orthant;

namespace {

constexpr double kDuration = 0.2;                        // [s]
constexpr double kTargets[] = {1e-2, 1e-3, 1e-6, 1e-9};  // [rad]

struct Plan {
  std::filesystem::path output = "results/work_precision", rivals;
  std::vector<std::string> names;  // of integrators
  std::string solver = "lemke";
  int repeats = 3;
  double time_limit = 10;  // [s] of a rival's run
  bool quick = false;
};
struct Setting {
  std::string spec;  // integrator
  double value = 0;  // step size [s] or tolerance
  double step = 0;   // of the calls [s]
};
struct Result {
  double error = kInf, seconds = kInf;
  Run run;
};

std::vector<Setting> ladder(const std::string& name, bool tolerances, bool quick) {
  std::vector<Setting> settings;
  if (tolerances)
    for (double tolerance = 1e-3; tolerance > 0.9e-13; tolerance /= quick ? 100 : 10)
      settings.push_back(
          {name + ":rtol=" + detail::text_of(tolerance) + ",atol=" + detail::text_of(std::max(1e-3 * tolerance, 1e-15)),
           tolerance, kDuration});
  else
    for (double steps = 250; steps < (quick ? 9e3 : 2.6e5); steps *= 2)
      settings.push_back({name, kDuration / steps, kDuration / steps});
  return settings;
}

Result measure(const Setting& setting, const SliderCrankExact& exact, const std::string& solver, int repeats) {
  const System system(slider_crank({.mu = exact.mu, .e = exact.e}));
  Result r;
  for (int k = 0; k < repeats && (k == 0 || r.seconds < 0.5); ++k) {
    const auto integrator = make_integrator(setting.spec, system);
    r.run = simulate(*integrator, *make_solver(solver), {.step = setting.step, .duration = kDuration});
    r.seconds = std::min(r.seconds, r.run.seconds);
  }
  if (r.run.status == Status::solved) r.error = std::abs(r.run.final.q[2] - exact.theta1);
  return r;
}

/// Its processor time; repeated like the others' runs, but not where that takes long.
Result measure(const Setting& setting, const SliderCrankExact& exact, const Rival& rival, const Plan& plan) {
  Result r;
  r.run.status = Status::not_run;
  Isolated processes(1, 0);
  for (int k = 0; k < plan.repeats && (k == 0 || r.seconds < 0.1); ++k) {
    processes.start(
        [&] {
          return output_of({rival.program.string(), rival.method, detail::text_of(exact.mu), detail::text_of(exact.e),
                            detail::text_of(setting.value)});
        },
        plan.time_limit + 3, [&](const Outcome& outcome) {  // [s] the rest: to start
          double theta1 = 0, seconds = 0;
          const auto line = outcome.text.find_last_of('\n', std::max<std::size_t>(outcome.text.size(), 2) - 2);
          std::istringstream text(outcome.text.substr(line == std::string::npos ? 0 : line + 1));  // the last
          const bool answered = outcome.kind == Outcome::finished && text >> theta1 >> seconds >> r.run.steps;
          r.run.status = answered                          ? Status::solved
                         : outcome.kind == Outcome::killed ? Status::time_limit
                                                           : Status::numerical_error;
          if (!answered) return;
          r.error = std::abs(theta1 - exact.theta1);
          r.seconds = std::min(r.seconds, seconds);
        });
    processes.wait_for_all();
    if (r.run.status != Status::solved) break;
  }
  r.run.accepted = r.run.steps;
  return r;
}

/// Of results from coarse to fine.
double time_to(double target, const std::vector<Result>& results) {
  double seconds = kInf;
  for (auto r = results.rbegin(); r != results.rend() && r->error <= target; ++r)
    seconds = std::min(seconds, r->seconds);
  return seconds;
}

std::string number(double x) { return std::isfinite(x) ? detail::text_of(x) : ""; }

/// One integrator or rival: its rows of the table of runs, and its row of times to errors.
void study(const std::string& name, const Rival* rival, const Plan& plan, std::string& runs, std::string& table) {
  const bool tolerances = rival != nullptr ? rival->takes == "tolerance" : name == "adaptive" || name == "event-driven";
  std::array<double, std::size(kTargets)> worst{};
  for (const SliderCrankExact& exact : slider_crank_exact()) {
    std::vector<Result> results;
    int late = 0;
    for (const Setting& setting : ladder(name, tolerances, plan.quick)) {
      const Result& r = results.emplace_back(rival != nullptr ? measure(setting, exact, *rival, plan)
                                                              : measure(setting, exact, plan.solver, plan.repeats));
      runs += name;
      for (const double x : {setting.value, exact.mu, exact.e}) runs += ',' + number(x);
      runs += ',' + std::string(orthant::name(r.run.status));
      for (const double x :
           {r.error, r.seconds, static_cast<double>(r.run.accepted), static_cast<double>(r.run.rejected),
            static_cast<double>(r.run.lcp_solves), static_cast<double>(r.run.events), r.run.max_joint_residual})
        runs += ',' + number(x);
      runs += '\n';
      late += r.run.status == Status::time_limit;  // some get stuck at large steps, and not at small ones
      if (rival != nullptr && (late > 1 || (r.error < kInf && r.seconds > plan.time_limit / 2))) break;
    }
    for (std::size_t k = 0; k < std::size(kTargets) && exact.e <= 0.4; ++k)
      worst[k] = std::max(worst[k], time_to(kTargets[k], results));
  }
  table += name;
  std::cout << "| `" << name << "` |";
  for (const double seconds : worst) {
    table += ',' + number(seconds);
    std::cout << ' ' << (seconds < kInf ? detail::text_of(std::round(1e5 * seconds) / 100) : "-") << " |";
  }
  table += '\n';
  std::cout << std::endl;
}

void run(const Plan& plan, const std::string& command_line) {
  const System system(slider_crank({}));
  for (const std::string& name : plan.names) make_integrator(name, system);  // throws if unknown
  make_solver(plan.solver);
  const std::vector<Rival> others = plan.rivals.empty() ? std::vector<Rival>{} : rivals(plan.rivals);
  std::filesystem::create_directories(plan.output);
  check_writable(plan.output / "runs.csv");
  std::string runs =
      "integrator,setting,mu,e,status,error,seconds,accepted,rejected,lcp_solves,events,joint_residual\n";
  std::string table = "integrator,to_1e-2,to_1e-3,to_1e-6,to_1e-9\n";
  std::cout << "worst time to an error of theta1(0.2 s) over mu in {0, .01, .1}, e in {0, .4} [ms]\n"
            << "| integrator | 1e-2 | 1e-3 | 1e-6 | 1e-9 |\n|---|---|---|---|---|\n";
  Progress progress("work-precision", static_cast<double>(plan.names.size() + others.size()));
  for (const std::string& name : plan.names) {
    study(name, nullptr, plan, runs, table);
    progress.add(1, false);
  }
  for (const Rival& rival : others) {
    if (rival.absent.empty())
      study(rival.name, &rival, plan, runs, table);
    else
      std::cout << "| `" << rival.name << "` | absent: " << rival.absent << " |\n", table += rival.name + ",,,,\n";
    progress.add(1, !rival.absent.empty());
  }
  write_whole(plan.output / "runs.csv", runs);
  write_whole(plan.output / "time_to_error.csv", table);
  auto about = manifest();
  about["command"] = command_line;
  about["options"] = {{"solver", plan.solver}, {"repeats", plan.repeats},       {"integrators", plan.names},
                      {"rivals", plan.rivals}, {"time_limit", plan.time_limit}, {"quick", plan.quick}};
  write_whole(plan.output / "manifest.json", about.dump(2) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  CLI::App app("Slider-crank with clearance: time to an error, for every integrator");
  app.add_option("--output", plan.output, "folder for tables and manifest")->capture_default_str();
  app.add_option("--integrators", plan.names, "NAME ...; default: all of the registry");
  app.add_option("--solver", plan.solver, "NAME[:option=value,...]")->capture_default_str();
  app.add_option("--repeats", plan.repeats, "of each run, the fastest counts")->check(CLI::Range(1, 100));
  app.add_option("--rivals", plan.rivals, "folder of rivals' drivers; they take part as well");
  app.add_option("--time-limit", plan.time_limit, "of a rival's run [s]")
      ->check(between(1e-3, 1e6))
      ->capture_default_str();
  app.add_flag("--quick", plan.quick, "fewer and coarser settings");
  if (const auto end = parse(app, argc, argv)) return *end;
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  try {
    if (plan.names.empty())
      for (const IntegratorEntry& entry : integrators()) plan.names.emplace_back(entry.name);
    run(plan, command_line);
  } catch (const std::exception& error) {
    std::cerr << "work_precision: " << error.what() << '\n';
    return 1;
  }
}

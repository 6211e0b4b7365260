// What does an error cost on the slider-crank, by every integrator?
//
// Each integrator over a ladder of step sizes, or of tolerances, on μ × e; errors of θ₁(0.2 s) against the exact motion,
// the fastest of the repeats. "Time to ε" is that of the cheapest setting from which on every finer one stays below ε, so
// that no lucky run counts; the table shows the worst over the cases with e ≤ 0.4. Writes all runs and that table.
#include "experiments/support/manifest.h"
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

using namespace orthant;

namespace {

constexpr double kDuration = 0.2;                        // [s]
constexpr double kTargets[] = {1e-2, 1e-3, 1e-6, 1e-9};  // [rad]

struct Setting {
  std::string spec;  // integrator
  double value = 0;  // step size [s] or tolerance
  double step = 0;   // of the calls [s]
};
struct Result {
  double error = kInf, seconds = kInf;
  Run run;
};

std::vector<Setting> ladder(const std::string& name, bool quick) {
  std::vector<Setting> settings;
  if (name == "adaptive" || name == "event-driven")
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

/// Of results from coarse to fine.
double time_to(double target, const std::vector<Result>& results) {
  double seconds = kInf;
  for (auto r = results.rbegin(); r != results.rend() && r->error <= target; ++r)
    seconds = std::min(seconds, r->seconds);
  return seconds;
}

std::string number(double x) { return std::isfinite(x) ? detail::text_of(x) : ""; }

void run(const std::filesystem::path& output, const std::string& solver, int repeats, bool quick,
         const std::string& command_line) {
  std::filesystem::create_directories(output);
  std::string runs =
      "integrator,setting,mu,e,status,error,seconds,accepted,rejected,lcp_solves,events,joint_residual\n";
  std::string table = "integrator,to_1e-2,to_1e-3,to_1e-6,to_1e-9\n";
  std::cout << "worst time to an error of theta1(0.2 s) over mu in {0, .01, .1}, e in {0, .4} [ms]\n"
            << "| integrator | 1e-2 | 1e-3 | 1e-6 | 1e-9 |\n|---|---|---|---|---|\n";
  Progress progress("work-precision", static_cast<double>(integrators().size()));
  for (const IntegratorEntry& entry : integrators()) {
    const std::string name(entry.name);
    std::array<double, std::size(kTargets)> worst{};
    for (const SliderCrankExact& exact : slider_crank_exact()) {
      std::vector<Result> results;
      for (const Setting& setting : ladder(name, quick)) {
        const Result& r = results.emplace_back(measure(setting, exact, solver, repeats));
        runs += name;
        for (const double x : {setting.value, exact.mu, exact.e}) runs += ',' + number(x);
        runs += ',' + std::string(orthant::name(r.run.status));
        for (const double x :
             {r.error, r.seconds, static_cast<double>(r.run.accepted), static_cast<double>(r.run.rejected),
              static_cast<double>(r.run.lcp_solves), static_cast<double>(r.run.events), r.run.max_joint_residual})
          runs += ',' + number(x);
        runs += '\n';
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
    progress.add(1, false);
  }
  write_whole(output / "runs.csv", runs);
  write_whole(output / "time_to_error.csv", table);
  auto about = manifest();
  about["command"] = command_line;
  about["options"] = {{"solver", solver}, {"repeats", repeats}, {"quick", quick}};
  write_whole(output / "manifest.json", about.dump(2) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path output = "results/work_precision";
  std::string solver = "lemke";
  int repeats = 3;
  bool quick = false;
  CLI::App app("Slider-crank with clearance: time to an error, for every integrator");
  app.add_option("--output", output, "folder for tables and manifest")->capture_default_str();
  app.add_option("--solver", solver, "NAME[:option=value,...]")->capture_default_str();
  app.add_option("--repeats", repeats, "of each run, the fastest counts")->check(CLI::Range(1, 100));
  app.add_flag("--quick", quick, "fewer and coarser settings");
  CLI11_PARSE(app, argc, argv);
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  try {
    run(output, solver, repeats, quick, command_line);
  } catch (const std::exception& error) {
    std::cerr << "work_precision: " << error.what() << '\n';
    return 1;
  }
}

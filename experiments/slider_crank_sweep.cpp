// How fast does time stepping converge on the slider-crank with clearance, and what does an error cost?
//
// Step size × friction × restitution × joint treatment against the exact motion. Errors come from all cores; times from
// a second pass that has the machine to itself. Writes one table, one table of fitted orders, trajectories, a manifest.
#include "experiments/support/fit_order.h"
#include "experiments/support/manifest.h"
#include "experiments/support/parallel.h"
#include "experiments/support/progress.h"
#include "experiments/support/trajectory.h"

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <iostream>
#include <map>

using namespace orthant;

namespace {

struct Case {
  std::string integrator, solver;
  double mu = 0, e = 0, h = 0;
  bool timed = false;
  Run run;
  double error = kInf;  // |θ₁(0.2 s) − exact| [rad]
};

void solve(Case& c, int repeats, const Recorder& record = {}) {
  const System system(slider_crank({.mu = c.mu, .e = c.e}));
  double best = kInf;
  for (int i = 0; i < repeats; ++i) {
    const auto integrator = make_integrator(c.integrator, system);
    const auto solver = make_solver(c.solver);
    c.run = simulate(*integrator, *solver, {.step = c.h, .duration = system.scene().duration, .every = 1}, record);
    best = std::min(best, c.run.seconds);
  }
  c.run.seconds = best;
  const auto exact = slider_crank_exact(c.mu, c.e);
  if (exact && c.run.status == Status::solved) c.error = std::abs(c.run.final.q[2] - exact->theta1);
}

std::string row(const Case& c) {
  std::string text = '"' + c.integrator + "\"," + c.solver;
  const Run& r = c.run;
  const double steps = static_cast<double>(std::max(1L, r.steps));
  for (const double x :
       {c.mu, c.e, c.h, steps, c.error, c.timed ? r.seconds : kInf, c.timed ? 1e6 * r.seconds / steps : kInf,
        static_cast<double>(r.lcp_solves), static_cast<double>(r.lcp_iterations), r.max_lcp_residual,
        r.max_joint_residual, r.max_penetration, r.energy_final})
    text += std::isfinite(x) ? "," + detail::text_of(x) : ",";  // not measured: empty
  return text + "," + std::string(name(r.status)) + "\n";
}
constexpr const char* kHeader =
    "integrator,solver,mu,e,h,steps,error,seconds,us_per_step,lcp_solves,lcp_iterations,max_lcp_residual,"
    "max_joint_residual,max_penetration,energy,status\n";

struct Plan {
  std::filesystem::path output = "results/slider_crank";
  unsigned jobs = 0;
  bool quick = false;
  std::vector<std::string> integrators = {"moreau-jean:joints=position", "moreau-jean:joints=symmetric"};
  std::string solver = "lemke";
  Ladder ladder{.coarsest = 2.56e-4, .octaves = 7, .steps_per_octave = 16, .duration = 0.2};
};

std::vector<Case> cases_of(const Plan& plan) {
  std::vector<Case> cases;
  for (const auto& integrator : plan.integrators)
    for (const SliderCrankExact& exact : slider_crank_exact())
      for (const double h : step_sizes(plan.ladder)) cases.push_back({integrator, plan.solver, exact.mu, exact.e, h});
  return cases;
}

/// Time to an error: one step size an octave, alone on the machine, the fastest of three; then other solvers at one h.
std::vector<Case> timed_cases(const Plan& plan) {
  std::vector<Case> cases;
  for (const auto& integrator : plan.integrators)
    for (double h = plan.quick ? 1e-4 : 1e-3; h > 0.9e-6; h /= 2)
      cases.push_back(
          {integrator, plan.solver, 0.01, 0.4, plan.ladder.duration / std::round(plan.ladder.duration / h)});
  for (const char* solver : {"lemke", "pgs", "enumerate"})
    cases.push_back({"moreau-jean:joints=symmetric", solver, 0.01, 0.4, 1e-5});
  cases.push_back({"moreau-jean:joints=symmetric,form=full", "lemke", 0.01, 0.4, 1e-5});
  for (Case& c : cases) c.timed = true;
  return cases;
}

std::string orders(const std::vector<Case>& cases) {
  std::map<std::tuple<std::string, double, double>, std::vector<Sample>> groups;
  for (const Case& c : cases)
    if (std::isfinite(c.error)) groups[{c.integrator, c.mu, c.e}].push_back({c.h, c.error});
  std::string text = "integrator,mu,e,order,scatter,worst_error_finest_octave,h_finest_octave\n";
  for (const auto& [key, samples] : groups) {
    const Fit fit = fit_order(samples);
    text += '"' + std::get<0>(key) + '"';
    for (const double x :
         {std::get<1>(key), std::get<2>(key), fit.order, fit.scatter, fit.worst.back().error, fit.worst.back().h})
      text += "," + detail::text_of(x);
    text += '\n';
  }
  return text;
}

/// Fine runs for the pictures: the slider's path, contact phases, energy; about 4000 rows each.
void write_trajectory(const Plan& plan, double mu, double e) {
  const double h = plan.quick ? 1e-5 : 1e-6;
  Case c{"moreau-jean:joints=symmetric", plan.solver, mu, e, h};
  const System system(slider_crank({.mu = mu, .e = e}));
  const auto integrator = make_integrator(c.integrator, system);
  const auto solver = make_solver(c.solver);
  std::vector<double> table;
  simulate(*integrator, *solver, {.step = h, .duration = 0.2, .every = plan.quick ? 5 : 50},
           [&](const Moment& moment) { append_row(system, moment, table); });
  write_whole(plan.output / ("trajectory_mu" + detail::text_of(mu) + "_e" + detail::text_of(e) + ".csv"),
              to_csv(trajectory_columns(system.scene()), table));
}

void run(const Plan& plan, const std::string& command_line) {
  std::filesystem::create_directories(plan.output);
  std::vector<Case> cases = cases_of(plan);
  double work = 0;
  for (const Case& c : cases) work += 1 / c.h;
  {
    Progress progress("errors", work);
    parallel_for(cases.size(), plan.jobs, [&](std::size_t i) {
      solve(cases[i], 1);
      progress.add(1 / cases[i].h, cases[i].run.status != Status::solved);
    });
  }
  std::vector<Case> timed = timed_cases(plan);
  {
    double timed_work = 0;
    for (const Case& c : timed) timed_work += 1 / c.h;
    Progress progress("times", timed_work);
    for (Case& c : timed) {
      solve(c, 3);
      progress.add(1 / c.h, c.run.status != Status::solved);
    }
  }
  std::string table = kHeader;
  for (const auto* part : {&timed, &cases})
    for (const Case& c : *part) table += row(c);
  write_whole(plan.output / "sweep.csv", table);
  write_whole(plan.output / "orders.csv", orders(cases));
  for (const double mu : {0.0, 0.01, 0.1}) write_trajectory(plan, mu, 0.4);
  auto about = manifest();
  about["command"] = command_line;
  about["options"] = {{"integrators", plan.integrators},
                      {"solver", plan.solver},
                      {"jobs", plan.jobs},
                      {"quick", plan.quick},
                      {"coarsest_step", plan.ladder.coarsest},
                      {"octaves", plan.ladder.octaves},
                      {"steps_per_octave", plan.ladder.steps_per_octave}};
  write_whole(plan.output / "manifest.json", about.dump(2) + "\n");
  std::cout << orders(cases) << kHeader;
  for (const Case& c : timed) std::cout << row(c);
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  CLI::App app("Slider-crank with clearance: error and time against step size, friction, restitution, joint treatment");
  app.add_option("--output", plan.output, "folder for tables, trajectories and manifest")->capture_default_str();
  app.add_option("--jobs", plan.jobs, "threads of the error pass; 0: one a core")->capture_default_str();
  app.add_option("--integrators", plan.integrators, "NAME[:option=value,...]; may be repeated")->capture_default_str();
  app.add_option("--solver", plan.solver, "NAME[:option=value,...]")->capture_default_str();
  app.add_flag("--quick", plan.quick, "a reduced ladder of step sizes");
  CLI11_PARSE(app, argc, argv);
  if (plan.quick) plan.ladder = {.coarsest = 1.28e-4, .octaves = 5, .steps_per_octave = 8, .duration = 0.2};
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  try {
    run(plan, command_line);
  } catch (const std::exception& error) {
    std::cerr << "slider_crank_sweep: " << error.what() << '\n';
    return 1;
  }
}

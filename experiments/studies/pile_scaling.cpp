// Growth of the cost of a pile with its size: discs in a trough, or spheres in a well.
//
// Each pile settles; `--by` solves its steps. Two Markdown tables. The first has the processor time of the last steps
// per body and per contact: without the solver (broad phase, rows, the problem, the motion), and of the solver. It also
// has the memory at its peak per body, the last residual and the largest overlap. The second has each solver's time on
// the last step's problem, from a cold start, until the judge accepts a residual (relative to the problem's data).
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/reference_kernel.h"

#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

using namespace orthant;

namespace {

/// Another solver, and the time that it takes.
class Timed final : public Solver {
 public:
  Timed(const std::string& spec, double tolerance) : by_(make_solver(with(spec, tolerance))), tolerance_(tolerance) {}
  double seconds = 0;

 private:
  static std::string with(const std::string& spec, double tolerance) {
    std::ostringstream full;
    full << spec << (spec.find(':') == std::string::npos ? ':' : ',') << "tolerance=" << tolerance;
    return full.str();
  }
  Claim run(const Lcp& problem, Solution& s, Start start) override {
    const double begin = thread_time();
    by_->set_time_limit(budget().remaining());
    by_->solve(problem, s, start);
    seconds += thread_time() - begin;
    return handed_on(Solution(s), s);
  }
  bool takes_discs() const override { return true; }  // the other one makes pyramids of them where it does not
  double tolerance() const override { return tolerance_; }
  std::unique_ptr<Solver> by_;
  double tolerance_;
};

/// Time in ms, or why there is none.
std::string cold(const Lcp& problem, const std::string& spec, double tolerance, double time_limit) {
  Timed solver(spec, tolerance);
  solver.set_time_limit(time_limit);
  Solution s;
  const double begin = thread_time();
  if (solver.solve(problem, s).status != Status::solved) return std::string(name(s.status));
  std::ostringstream time;
  time << std::setprecision(3) << 1e3 * (thread_time() - begin);
  return time.str();
}

constexpr double kSettling = 1e-6;  // default tolerance of the steps
constexpr long kCounted = 20;       // of the last steps

struct Settling {
  std::string by;
  double fall, h, tolerance, time_limit;  // [s], –, [s]
};

/// What the last steps cost and reached.
struct Cost {
  double outside = 0, inside = 0;        // [s] a step: without its solver, and of it
  double residual = 0, penetration = 0;  // the largest [relative, m]
  Lcp problem;                           // of the last step
};

double peak_memory() {  // [B]
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// Throws std::runtime_error with the reason where a step ends without an answer.
template <class System> Cost settled(const System& system, const Settling& way) {
  const auto scheme = make_integrator("moreau-jean", system);
  Timed solver(way.by, way.tolerance);
  State x = system.initial_state();
  Cost cost;
  const long steps = std::lround(way.fall / way.h), counted = std::min(steps, kCounted);
  for (long k = 0; k < steps; ++k) {
    const double begin = thread_time(), before = solver.seconds;
    const StepReport report = scheme->step(way.h, solver, x);
    if (report.status != Status::solved)
      throw std::runtime_error("step " + std::to_string(k) + ": " + std::string(scheme->why()));
    if (k < steps - counted) continue;
    cost.inside += (solver.seconds - before) / static_cast<double>(counted);
    cost.outside += (thread_time() - begin - (solver.seconds - before)) / static_cast<double>(counted);
    cost.residual = std::max(cost.residual, report.lcp_residual);
    cost.penetration = std::max(cost.penetration, report.penetration);
  }
  cost.problem = scheme->problem();
  return cost;
}

Cost settled(int dimension, int bodies, const Settling& way) {
  if (dimension == 2) return settled(System(pile({.discs = bodies})), way);
  return settled(SystemOf<Spatial>(spheres({.count = bodies})), way);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app(
      "Growth of the cost of a pile of discs or spheres: assembly per body and step, solvers at equal residual");
  std::vector<int> sizes{10, 30, 100, 300, 1000, 3000, 10000};
  std::vector<std::string> specs{"pgs", "nncg", "newton-min", "newton-fb", "auto"};
  std::vector<double> tolerances{1e-3, 1e-6, 1e-9};
  int dimension = 2;
  bool steps_only = false;
  Settling way{.by = "nncg", .fall = 0.3, .h = 1e-3, .tolerance = kSettling, .time_limit = 5};
  app.add_option("--dimension", dimension, "2: discs in a trough, 3: spheres in a well")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  app.add_option("--sizes", sizes, "numbers of bodies")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--solvers", specs, "without a tolerance")->capture_default_str();
  app.add_flag("--steps-only", steps_only, "without the second table");
  app.add_option("--tolerances", tolerances, "relative residuals")->check(between(1e-14, 1.0))->capture_default_str();
  app.add_option("--by", way.by, "solver of the steps while the pile settles")->capture_default_str();
  app.add_option("--by-tolerance", way.tolerance, "its relative residual")
      ->check(between(1e-14, 1.0))
      ->capture_default_str();
  app.add_option("--fall", way.fall, "time to settle [s]")->check(between(1e-3, 1e3))->capture_default_str();
  app.add_option("--step", way.h, "[s]")->check(between(1e-6, 1e-1))->capture_default_str();
  app.add_option("--time-limit", way.time_limit, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  for (const std::string& spec : specs) Timed(spec, kSettling);
  Timed(way.by, kSettling);  // an unknown one is refused before the table

  const std::string bodies = dimension == 2 ? "discs" : "spheres";
  std::ostringstream solves;
  solves << "| " << bodies << " | rows | residual |";
  for (const std::string& spec : specs) solves << " `" << spec << "`, ms |";
  solves << "\n|---|---|---|";
  for (std::size_t i = 0; i < specs.size(); ++i) solves << "---|";
  solves << '\n' << std::setprecision(3);
  std::cout << "| " << bodies
            << " | contacts | rows | without the solver, µs a body | the solver, µs a body | both, µs a contact "
               "| memory, kB a body | residual | overlap, mm |\n"
               "|---|---|---|---|---|---|---|---|---|\n"
            << std::setprecision(3);
  for (const int count : sizes) {
    Cost cost;
    try {
      cost = settled(dimension, count, way);
    } catch (const std::runtime_error& error) {
      std::cerr << "pile_scaling: " << count << ' ' << bodies << ", " << error.what() << '\n';
      return 3;
    }
    const double each = 1e6 / count;
    const auto contacts = static_cast<double>(cost.problem.friction.size());
    std::cout << "| " << count << " | " << contacts << " | " << cost.problem.size() << " | " << each * cost.outside
              << " | " << each * cost.inside << " | "
              << (contacts > 0 ? 1e6 * (cost.outside + cost.inside) / contacts : 0) << " | "
              << 1e-3 * peak_memory() / count << " | " << cost.residual << " | " << 1e3 * cost.penetration << " |"
              << std::endl;
    if (steps_only || contacts == 0) continue;
    for (const double tolerance : tolerances) {
      solves << "| " << count << " | " << cost.problem.size() << " | " << tolerance << " |";
      for (const std::string& spec : specs)
        solves << ' ' << cold(cost.problem, spec, tolerance, way.time_limit) << " |";
      solves << '\n';
    }
  }
  if (!steps_only) std::cout << '\n' << solves.str();
} catch (const std::exception& error) {  // an unknown solver or option
  std::cerr << "pile_scaling: " << error.what() << '\n';
  return 1;
}

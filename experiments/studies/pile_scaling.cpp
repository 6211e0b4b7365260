// What does a pile cost as it grows? Discs dropped into a trough: a step per disc without its solver, and what
// the step's problem takes each solver, at equal residual.
//
// Each pile settles, its steps solved by `--by`. Two Markdown tables: of the last steps, processor time a disc, without
// the solver (broad phase, rows, the problem, the motion) and of it; of the last step's problem, cold, each solver's
// time until the judge accepts a residual (relative to the problem's data), or what became of it.
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/reference_kernel.h"

#include <orthant/core/scenes/pile.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <iomanip>
#include <iostream>
#include <sstream>

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

constexpr double kSettling = 1e-6;  // tolerance of the steps
constexpr long kCounted = 20;       // of the last steps

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("What a pile of discs costs as it grows: assembly a disc and step, solvers at equal residual");
  std::vector<int> sizes{10, 30, 100, 300, 1000, 3000, 10000};
  std::vector<std::string> specs{"pgs", "nncg", "newton-min", "newton-fb", "auto"};
  std::vector<double> tolerances{1e-3, 1e-6, 1e-9};
  std::string by = "nncg";
  double fall = 0.3, h = 1e-3, time_limit = 5;
  app.add_option("--sizes", sizes, "numbers of discs")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--solvers", specs, "without a tolerance")->capture_default_str();
  app.add_option("--tolerances", tolerances, "relative residuals")->check(between(1e-14, 1.0))->capture_default_str();
  app.add_option("--by", by, "solver of the steps while the pile settles")->capture_default_str();
  app.add_option("--fall", fall, "time to settle [s]")->check(between(1e-3, 1e3))->capture_default_str();
  app.add_option("--step", h, "[s]")->check(between(1e-6, 1e-1))->capture_default_str();
  app.add_option("--time-limit", time_limit, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  for (const std::string& spec : specs) Timed(spec, kSettling);
  Timed(by, kSettling);  // an unknown one is refused before the table

  std::ostringstream solves;
  solves << "| discs | rows | residual |";
  for (const std::string& spec : specs) solves << " `" << spec << "`, ms |";
  solves << "\n|---|---|---|";
  for (std::size_t i = 0; i < specs.size(); ++i) solves << "---|";
  solves << '\n' << std::setprecision(3);
  std::cout << "| discs | rows | a step without its solver, µs a disc | its solver, µs a disc |\n|---|---|---|---|\n"
            << std::setprecision(3);
  for (const int discs : sizes) {
    const System system(pile({.discs = discs}));
    const auto scheme = make_integrator("moreau-jean", system);
    Timed solver(by, kSettling);
    State x = system.initial_state();
    double spent = 0, inside = 0;
    const long steps = std::lround(fall / h);
    for (long k = 0; k < steps; ++k) {
      const double begin = thread_time(), before = solver.seconds;
      if (scheme->step(h, solver, x).status != Status::solved) {
        std::cerr << "pile_scaling: " << discs << " discs, step " << k << ": " << scheme->why() << '\n';
        return 3;
      }
      if (k >= steps - kCounted) spent += thread_time() - begin, inside += solver.seconds - before;
    }
    const Lcp problem = scheme->problem();
    const double each = 1e6 / static_cast<double>(std::min(steps, kCounted)) / discs;
    std::cout << "| " << discs << " | " << problem.size() << " | " << each * (spent - inside) << " | " << each * inside
              << " |" << std::endl;
    for (const double tolerance : tolerances) {
      solves << "| " << discs << " | " << problem.size() << " | " << tolerance << " |";
      for (const std::string& spec : specs) solves << ' ' << cold(problem, spec, tolerance, time_limit) << " |";
      solves << '\n';
    }
  }
  std::cout << '\n' << solves.str();
} catch (const std::exception& error) {  // an unknown solver or option
  std::cerr << "pile_scaling: " << error.what() << '\n';
  return 1;
}

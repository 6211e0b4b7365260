// Growth of the cost of a pile with its size: discs in a trough, spheres in a well, or bodies poured into a box.
//
// Each pile settles; `--by` solves its steps. Two Markdown tables. The first has, of the last steps: sweeps (or other
// iterations of the solver), processor time per contact of a whole step, memory per body (scene, system, integrator)
// and per contact (all that steps add), the peak of the process, the residual as a share of g h, the largest overlap.
// Contacts are those of a step's problem.
// With several numbers of threads the last steps take them by turns, on one motion, and wall times follow. Below it
// stands the slope of each quantity in a log-log fit over the number of contacts. The second table has each solver's
// time on the last step's problem, from a cold start, until the judge accepts a residual (relative to the problem's
// data).
// With --data there is one CSV file instead, of all --kinds (data_file.h). The last steps of each pile are taken again,
// from the same settled state, by each of --solvers to each of --tolerances in each number of threads.
// With --columns there is another table (columns.h), to the first of the tolerances.
#include "experiments/studies/pile_scaling/columns.h"
#include "experiments/studies/pile_scaling/data_file.h"
#include "experiments/studies/pile_scaling/pile_motion.h"
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"

#include <CLI/CLI.hpp>

#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>

using namespace orthant;

namespace {

/// Time in ms, or why there is none.
std::string cold(const Lcp& problem, const std::string& spec, double tolerance, double time_limit) {
  const auto solver = make_solver(with(spec, tolerance));
  solver->set_time_limit(time_limit);
  Solution s;
  const double begin = thread_time();
  if (solver->solve(problem, s).status != Status::solved) return std::string(name(s.status));
  std::ostringstream time;
  time << std::setprecision(3) << 1e3 * (thread_time() - begin);
  return time.str();
}

/// Slope of the least-squares line through (log x, log y).
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0 && y[i] > 0)) continue;
    const double a = std::log(x[i]), b = std::log(y[i]);
    n += 1, sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// The two tables; without `specs` the first alone. Returns the exit code: 3 where a step has no answer.
int print_tables(const Bodies& piled, const std::vector<int>& sizes, const std::vector<std::string>& specs,
                 const std::vector<double>& tolerances, const Settling& way) {
  const bool steps_only = specs.empty();
  const std::string bodies = piled.kind == Kind::well ? "spheres" : piled.name;
  std::ostringstream solves;
  solves << "| " << bodies << " | rows | residual |";
  for (const std::string& spec : specs) solves << " `" << spec << "`, ms |";
  solves << "\n|---|---|---|";
  for (std::size_t i = 0; i < specs.size(); ++i) solves << "---|";
  solves << '\n' << std::setprecision(3);
  std::cout << "| " << bodies
            << " | contacts | sweeps | a step, µs a contact | B a body | B a contact | peak, MB | residual, g h "
               "| overlap, mm |";
  for (const int threads : way.threads) std::cout << " wall in " << threads << ", ms a step |";
  std::cout << "\n|---|---|---|---|---|---|---|---|---|";
  for (std::size_t i = 0; i < way.threads.size(); ++i) std::cout << "---|";
  std::cout << '\n' << std::setprecision(3);
  std::vector<double> contacts, seconds, sweeps, memory;
  for (const int count : sizes) {
    const Cost cost = piled.in_motion(count, [&](auto&& pile) {
      Cost last = pile.settle(way);
      if (last.status == Status::solved) last = pile.last_steps(way);
      if (!steps_only) last.problem = pile.problem();
      return last;
    });
    if (cost.status != Status::solved) {
      std::cerr << "pile_scaling: " << count << ' ' << bodies << ", " << cost.end << '\n';
      return 3;
    }
    contacts.push_back(cost.contacts), seconds.push_back(cost.seconds), sweeps.push_back(cost.iterations);
    memory.push_back(cost.body_bytes * count + cost.contact_bytes * cost.contacts);
    std::cout << "| " << count << " | " << std::lround(cost.contacts) << " | " << cost.iterations << " | "
              << (cost.contacts > 0 ? 1e6 * cost.seconds / cost.contacts : 0) << " | " << std::lround(cost.body_bytes)
              << " | " << std::lround(cost.contact_bytes) << " | " << std::lround(1e-6 * peak_memory()) << " | "
              << cost.residual << " | " << 1e3 * cost.penetration << " |";
    for (const double wall : cost.wall) std::cout << ' ' << 1e3 * wall << " |";
    std::cout << std::endl;
    if (steps_only || cost.contacts == 0) continue;
    for (const double tolerance : tolerances) {
      solves << "| " << count << " | " << cost.problem.size() << " | " << tolerance << " |";
      for (const std::string& spec : specs)
        solves << ' ' << cold(cost.problem, spec, tolerance, way.time_limit) << " |";
      solves << '\n';
    }
  }
  if (sizes.size() > 1)
    std::cout << "\nSlopes over the number of contacts: time " << slope(contacts, seconds) << ", sweeps "
              << slope(contacts, sweeps) << ", memory " << slope(contacts, memory) << '\n';
  if (!steps_only) std::cout << '\n' << solves.str();
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Growth of the cost of a pile: steps per body and contact, memory, solvers at equal residual");
  std::vector<int> sizes{10, 30, 100, 300, 1000, 3000, 10000};
  std::vector<std::string> specs{"pgs", "nncg", "newton-min", "newton-fb", "auto"};
  std::vector<double> tolerances{1e-3, 1e-6, 1e-9};
  int dimension = 2;
  bool steps_only = false;
  std::string poured, data;
  std::vector<std::string> kinds;
  bool append = false;
  std::vector<int> heights;
  Pour pouring;
  Settling way{
      .by = "nncg", .fall = 0.3, .h = 1e-3, .tolerance = kSettling, .time_limit = 5, .counted = 20, .threads = {1}};
  CLI::Option* dimension_option = app.add_option("--dimension", dimension, "2: discs in a trough, 3: spheres in a well")
                                      ->check(CLI::IsMember({2, 3}))
                                      ->capture_default_str();
  CLI::Option* pour_option =
      app.add_option("--pour", poured,
                     "in space, into a box of the ground's shapes: these bodies (core/scenes/spheres.h)")
          ->check(CLI::IsMember(std::vector<std::string>(Pour::kBodiesNames.begin(), Pour::kBodiesNames.end())));
  app.add_option("--apart", pouring.apart, "places of --pour, in diameters")
      ->check(between(1.0, 10.0))
      ->capture_default_str();
  app.add_option("--spread", pouring.spread, "of the sizes of --pour")->check(between(0.0, 0.5))->capture_default_str();
  app.add_option("--columns", heights, "the other table: of columns of so many spheres")->check(CLI::Range(1, 100000));
  app.add_option("--sizes", sizes, "numbers of bodies")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--solvers", specs, "of the second table, or of the last steps of --data; without a tolerance")
      ->capture_default_str();
  app.add_flag("--steps-only", steps_only, "without the second table");
  app.add_option("--tolerances", tolerances, "relative residuals")->check(between(1e-14, 1.0))->capture_default_str();
  app.add_option("--by", way.by, "solver of the steps while the pile settles")->capture_default_str();
  app.add_option("--by-tolerance", way.tolerance, "its relative residual")
      ->check(between(1e-14, 1.0))
      ->capture_default_str();
  app.add_option("--fall", way.fall, "time to settle [s]")->check(between(1e-3, 1e3))->capture_default_str();
  app.add_option("--step", way.h, "[s]")->check(between(1e-6, 1e-1))->capture_default_str();
  app.add_option("--counted", way.counted, "last steps that count")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--threads", way.threads, "inside the solver, by turns; of pgs, psor, sgs, nncg in space")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  CLI::Option* file = app.add_option("--data", data, "CSV file in place of the tables, with the cases that fail");
  app.add_option("--kinds", kinds, "of --data: discs, well (spheres in it), spheres, boxes, capsules, mixed (poured)")
      ->check(CLI::IsMember({"discs", "well", "spheres", "boxes", "capsules", "mixed"}))
      ->needs(file)
      ->excludes(pour_option)
      ->excludes(dimension_option);
  app.add_flag("--append", append, "to the file of --data")->needs(file);
  app.add_option("--time-limit", way.time_limit, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  if (!steps_only || !data.empty())  // an unknown one is refused before the table
    for (const std::string& spec : specs)
      for (const int threads : data.empty() ? std::vector{1} : way.threads) make_solver(with(spec, kSettling, threads));
  for (const int threads : data.empty() ? way.threads : std::vector{1}) make_solver(with(way.by, kSettling, threads));
  if (kinds.empty()) kinds = {!poured.empty() ? poured : dimension == 3 ? "well" : "discs"};

  if (!heights.empty()) {
    columns(heights, specs, tolerances.front(), way);
    return 0;
  }
  if (!data.empty()) {
    Cases cases{{}, sizes, specs, tolerances};
    for (const std::string& kind : kinds) cases.kinds.push_back(bodies_of(kind, pouring));
    return write_data(data, append, cases, way);
  }
  if (steps_only) specs.clear();
  return print_tables(bodies_of(kinds[0], pouring), sizes, specs, tolerances, way);
} catch (const std::exception& error) {  // an unknown solver or option
  std::cerr << "pile_scaling: " << error.what() << '\n';
  return 1;
}

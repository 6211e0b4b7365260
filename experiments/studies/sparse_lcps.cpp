// What do large sparse problems with bounds cost, in time, cycles and memory, as the grid is refined?
//
// Obstacle problems on grids in the plane and in space, and traffic equilibria, by solvers that factorize nothing, by
// active sets and by interior points, and by PETSc's SNESVI in the same run where its driver is given. Each case is a
// process of its own: its processor time, its residual as the independent judge recomputes it, and the most memory that
// it held (the problem included). A method that a smaller grid has cost the time limit is left out on larger ones.
// sparse_lcps.csv, and the same as Markdown.
#include "experiments/runs/manifest.h"
#include "experiments/studies/support/rivals.h"
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/isolated.h"

#include <orthant/core/lcp/problems/american_put.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/core/lcp/problems/traffic.h>
#include <orthant/core/support/file.h>
#include <orthant/solvers/registry.h>

#include <sys/resource.h>
#include <time.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>

using namespace orthant;

namespace {

struct Kind {
  const char* name;
  Index dimension;  // 0: a city
  Lcp (*make)(Index side);
};
const Kind kKinds[] = {
    {"ball", 2, [](Index side) { return ball_obstacle(side + 1).problem; }},
    {"journal", 2, [](Index side) { return journal_bearing(side, side); }},
    {"torsion", 2, [](Index side) { return elastic_plastic_torsion(side, side); }},
    {"basket", 2,
     [](Index side) {
       AmericanBasket basket;
       basket.nodes = side;
       return american_basket_step(basket, basket.payoff(), 0.02);
     }},
    {"space", 3, [](Index side) { return space_obstacle(side + 1).problem; }},
    {"traffic", 0, [](Index side) { return traffic_equilibrium(grid_city(side)); }},
};

struct Row {
  std::string status = "skipped";
  long n = 0, entries = 0;
  double residual = kInf, seconds = kInf, full = 0, megabytes = 0;
  int iterations = 0;
  long factorizations = 0;
  bool holds = false;
};

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double peak_megabytes(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

std::string measure(const Kind& kind, Index side, const std::string& solver, const Rival* rival, double limit) {
  Row row;
  const Lcp problem = kind.make(side);
  const double before = peak_megabytes(RUSAGE_SELF);
  row.n = problem.size();
  row.entries = static_cast<long>(std::get<RowSparse>(problem.A).value.size());
  Trial trial;
  if (rival != nullptr) {
    trial = try_rival(problem, *rival);
    row.megabytes = peak_megabytes(RUSAGE_CHILDREN);
  } else {
    const auto method = make_solver(solver);
    method->set_time_limit(limit);
    Solution s;
    const double begin = processor_seconds();
    method->solve(problem, s);
    trial.seconds = processor_seconds() - begin;
    row.megabytes = std::max(before, peak_megabytes(RUSAGE_SELF));
    row.factorizations = s.factorizations;
    row.full = s.factorized_rows / static_cast<double>(problem.size());
    trial.status = name(s.status), trial.iterations = s.iterations;
    judge_solution(problem, s.z, trial);
  }
  std::ostringstream text;
  text << std::setprecision(6) << trial.status << ' ' << row.n << ' ' << row.entries << ' ' << trial.residual << ' '
       << trial.holds << ' ' << trial.iterations << ' ' << row.factorizations << ' ' << row.full << ' ' << trial.seconds
       << ' ' << row.megabytes;
  return text.str();
}

/// The case in a process of its own.
Row row_of(const Kind& kind, Index side, const std::string& solver, const Rival* rival, double limit) {
  Row row;
  const auto take = [&row](const Outcome& outcome) {
    if (outcome.kind != Outcome::finished) {
      row.status = outcome.kind == Outcome::killed ? "late" : "crashed";
      return;
    }
    std::istringstream in(outcome.text);
    std::string residual, seconds;
    in >> row.status >> row.n >> row.entries >> residual >> row.holds >> row.iterations >> row.factorizations >>
        row.full >> seconds >> row.megabytes;
    row.residual = std::strtod(residual.c_str(), nullptr);
    row.seconds = std::strtod(seconds.c_str(), nullptr);
  };
  Isolated process(1, 0);
  process.start([&] { return measure(kind, side, solver, rival, limit); }, 2 * limit + 60, take);
  process.wait_for_all();
  return row;
}

/// The row of the CSV file, and of the Markdown table on the screen.
void write(std::ostream& csv, const Kind& kind, Index side, const std::string& solver, const Row& row) {
  csv << kind.name << ',' << side << ',' << row.n << ',' << row.entries << ',' << solver << ',' << row.status << ','
      << row.holds << ',' << row.residual << ',' << row.iterations << ',' << row.factorizations << ',' << row.full
      << ',' << row.seconds << ',' << row.megabytes << std::endl;
  std::cout << "| " << kind.name << " | " << row.n << " | `" << solver << "` | " << row.status
            << (row.holds || row.status != "solved" ? "" : ", wrong") << " | " << std::setprecision(2) << row.residual
            << " | " << row.iterations << " | " << row.factorizations << " | " << std::setprecision(3) << row.seconds
            << " | " << 1e6 * row.seconds / static_cast<double>(std::max(row.n, 1L)) << " | "
            << std::lround(row.megabytes) << " |" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Large sparse problems with bounds: time, cycles, residual and memory by the size of the grid");
  std::vector<std::string> problems{"ball", "journal", "torsion", "basket", "space", "traffic"};
  std::vector<Index> sides{63, 127, 255, 511, 1023}, cubes{15, 31, 63}, cities{8, 16, 32};
  std::vector<std::string> specs{"multigrid", "block-pivot", "interior-point", "auto"};
  std::string folder = "results/sparse_lcps", drivers;
  double limit = 120;
  bool quick = false;
  app.add_option("--problems", problems, "of ball, journal, torsion, basket, space, traffic")->capture_default_str();
  app.add_option("--sides", sides, "nodes of a side, in the plane")->check(CLI::Range(3, 5000))->capture_default_str();
  app.add_option("--cubes", cubes, "nodes of a side, in space")->check(CLI::Range(3, 400))->capture_default_str();
  app.add_option("--cities", cities, "crossings of a side, of traffic")
      ->check(CLI::Range(3, 200))
      ->capture_default_str();
  app.add_option("--solvers", specs, "as in orthant list, with options")->capture_default_str();
  app.add_option("--rivals", drivers, "folder of drivers: build/peers/lcp (experiments/run peers); PETSc's are used");
  app.add_option("--time-limit", limit, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  app.add_option("--output", folder, "folder of the table")->capture_default_str();
  app.add_flag("--quick", quick, "small grids only");
  if (const auto end = parse(app, argc, argv)) return *end;
  try {
    if (quick) sides = {63, 127, 255}, cubes = {15, 31}, cities = {8, 16};
    for (const std::string& spec : specs) make_solver(spec);  // an unknown one is refused before the table
    std::vector<Rival> others;
    if (!drivers.empty())
      for (Rival& rival : rivals(drivers))
        if (rival.name.starts_with("petsc")) others.push_back(std::move(rival));
    std::vector<const Kind*> kinds;
    for (const std::string& problem : problems) {
      const auto* const kind = std::ranges::find(kKinds, problem, &Kind::name);
      if (kind == std::end(kKinds))
        throw std::invalid_argument("--problems " + problem +
                                    ": must be ball, journal, torsion, basket, space or traffic");
      kinds.push_back(kind);
    }
    std::filesystem::create_directories(folder);
    write_whole(std::filesystem::path(folder) / "manifest.json", manifest().dump(2) + "\n");
    std::ofstream csv(std::filesystem::path(folder) / "sparse_lcps.csv");
    csv << "problem,side,n,entries,solver,status,holds,residual,iterations,factorizations,full,seconds,megabytes\n";
    std::cout << "| problem | n | solver | status | residual | iterations | factorizations | s | µs a row | MB |\n"
                 "|---|---|---|---|---|---|---|---|---|---|\n";
    bool all = true;
    for (const Kind* kind : kinds) {
      std::map<std::string, bool> late;
      for (const Index side : kind->dimension == 2 ? sides : kind->dimension == 3 ? cubes : cities) {
        const auto run = [&](const std::string& solver, const Rival* rival) {
          if (late[solver]) return;
          const Row row = row_of(*kind, side, solver, rival, limit);
          late[solver] = !row.holds;
          all = all && (rival != nullptr || row.holds);
          write(csv, *kind, side, solver, row);
        };
        for (const std::string& spec : specs) run(spec, nullptr);
        for (const Rival& rival : others) run(rival.name, &rival);
      }
    }
    return all ? 0 : 3;
  } catch (const std::exception& error) {
    std::cerr << "sparse_lcps: " << error.what() << '\n';
    return 1;
  }
}

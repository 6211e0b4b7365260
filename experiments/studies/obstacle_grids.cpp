// What does a large obstacle problem cost, relative to one factorization and solve?
//
// The ball obstacle on a grid by every method for such problems, each accepted by the judge, compared with the
// unrestricted Laplacian equation by CHOLMOD: factorizations counted where they are made (those of coarse grids too;
// "full" adds up their rows over n). Time: the best of `repeats`, the equation measured again before each method. A
// Markdown table.
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"

#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/linear_algebra/sparse_cholesky.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <chrono>
#include <iomanip>
#include <iostream>

using namespace orthant;

namespace {

template <class Work> double best_of(int repeats, const Work& work) {
  double best = kInf;
  for (int k = 0; k < repeats; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

double equation(const Lcp& problem, int repeats) {
  return best_of(repeats, [&] {
    SparseCholesky cholesky;  // analysis included: the methods pay for theirs
    Vector x = -problem.b;
    if (!cholesky.factorize(std::get<RowSparse>(problem.A), 0) || !cholesky.solve(x))
      throw std::runtime_error("CHOLMOD failed on the Laplacian");
  });
}

/// The last line of the log: who answered, for methods that ask others.
std::string last_event(const IterationLog& log) {
  for (auto entry = log.rbegin(); entry != log.rend(); ++entry)
    if (!entry->event.empty()) return entry->event;
  return "";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Large obstacle problems: factorizations, and time in units of one CHOLMOD factorization and solve");
  std::vector<Index> grids{128, 256, 512};
  std::vector<std::string> specs{"block-pivot", "newton-min", "path", "interior-point", "auto"};
  int repeats = 1;
  double time_limit = 600;
  app.add_option("--grids", grids, "interior nodes a side")->check(CLI::Range(2, 4096))->capture_default_str();
  app.add_option("--solvers", specs, "as in orthant list, with options")->capture_default_str();
  app.add_option("--repeats", repeats, "of each time")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--time-limit", time_limit, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;

  bool all = true;
  try {
    for (const std::string& spec : specs) make_solver(spec);  // an unknown one is refused before the table
    std::cout << "| n | solver | status | residual | iterations | factorizations | full | s | times the equation | "
                 "last event "
                 "|\n|---|---|---|---|---|---|---|---|---|---|\n";
    for (const Index grid : grids) {
      const Lcp problem = ball_obstacle(grid + 1).problem;
      const auto n = static_cast<double>(problem.size());
      for (const std::string& spec : specs) {
        const double unit = equation(problem, repeats);
        Solution s;
        IterationLog log;
        const double seconds = best_of(repeats, [&] {
          const auto solver = make_solver(spec);
          solver->set_time_limit(time_limit);
          solver->set_log(&log);
          solver->solve(problem, s);
        });
        all = all && s.status == Status::solved;
        std::cout << "| " << problem.size() << " | `" << spec << "` | " << name(s.status) << " | "
                  << std::setprecision(2) << s.residual << " | " << s.iterations << " | " << s.factorizations << " | "
                  << std::fixed << std::setprecision(1) << s.factorized_rows / n << " | " << seconds << " | "
                  << seconds / unit << " | " << last_event(log) << " |" << std::defaultfloat << std::endl;
      }
    }
  } catch (const std::exception& error) {
    std::cerr << "obstacle_grids: " << error.what() << '\n';
    return 1;
  }
  return all ? 0 : 3;
}
